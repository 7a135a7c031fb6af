"""Marlin's older names of boards, and the numbers by which old configurations name them."""

from __future__ import annotations

_RAMPS = {
    f"{stem}{digit}": f"RAMPS_{name}_{letters}"
    for stem, name in (("3", "13"), ("4", "14"), ("14", "PLUS"))
    for digit, letters in (("3", "EFB"), ("4", "EEB"), ("5", "EFF"), ("6", "EEF"))
}
# Of Marlin 1.1, MK4duo and StuFW.
NUMBERS = _RAMPS | {
    "3": "RAMPS_OLD",
    "40": "MKS_BASE",
    "47": "MKS_GEN_13",
    "53": "MKS_GEN_L",
    "63": "MELZI",
    "66": "MELZI_MAKR3D",
    "67": "AZTEEG_X3",
    "68": "AZTEEG_X3_PRO",
    "69": "ANET_10",
    "7": "ULTIMAKER",
    "72": "ULTIMAIN_2",
    "74": "GT2560_REV_A",
    "75": "GT2560_REV_A_PLUS",
    "77": "3DRAG",
    "78": "K8200",
    "80": "RUMBA",
    "81": "PRINTRBOARD",
    "811": "PRINTRBOARD_REVF",
    "89": "MELZI_CREALITY",
    "92": "MELZI_MALYAN",
    "200": "MIGHTYBOARD_REVE",
    "243": "RAMPS_ENDER_4",
    "301": "RAMBO",
    "302": "MINIRAMBO",
    "303": "MINIRAMBO_10A",
    "304": "EINSY_RAMBO",
    "343": "TRIGORILLA_13",
    "443": "TRIGORILLA_14",
    "505": "MELZI_TRONXY",
    "62": "SANGUINOLOLU_12",
    "1502": "RADDS",
}
RENAMED = {
    "MKS_13": "MKS_GEN_13",
    "TRIGORILLA": "TRIGORILLA_13",
    "SKR_MINI_E3_V2_0": "BTT_SKR_MINI_E3_V2_0",
    "BIGTREE_SKR_MINI_E3": "BTT_SKR_MINI_E3_V1_2",
    "BIGTREE_SKR_V1_3": "BTT_SKR_V1_3",
    "BIGTREE_SKR_V1_4": "BTT_SKR_V1_4",
    "BIGTREE_SKR_V1_4_TURBO": "BTT_SKR_V1_4_TURBO",
}


def known_name(written: str) -> str:
    """Marlin's present name of a board, without BOARD_, from a name or a number."""
    name = written.removeprefix("BOARD_")
    name = NUMBERS.get(name, name)
    return RENAMED.get(name, name)
