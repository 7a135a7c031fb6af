"""The registers of motor drivers and the fields in them, by the names of the data sheets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias


class Field(NamedTuple):
    """Adjacent bits of a register; `low` is the lowest bit. A `signed` field is a two's
    complement."""

    register: str
    low: int
    width: int = 1
    signed: bool = False

    @property
    def least(self) -> int:
        """The minimum value."""
        return -(1 << self.width - 1) if self.signed else 0

    @property
    def most(self) -> int:
        """The maximum value."""
        return (1 << self.width - self.signed) - 1

    def of(self, register: int) -> int:
        """The field's value in a register."""
        value = register >> self.low & (1 << self.width) - 1
        return value - (1 << self.width) if value > self.most else value

    def placed(self, value: int) -> int:
        """A register with this value in the field, and zeros elsewhere. Raises ValueError if the
        value does not fit."""
        if not self.least <= value <= self.most:
            raise ValueError(f"{value} is not within {self.least} to {self.most}")
        return (value & (1 << self.width) - 1) << self.low


@dataclass(frozen=True, slots=True)
class Register:
    """A register at an `address`; `access` is r, w or rw."""

    name: str
    address: int
    access: str
    fields: Mapping[str, Field]

    def unpack(self, value: int) -> dict[str, int]:
        """All fields in a value."""
        return {name: field.of(value) for name, field in self.fields.items()}


Layout: TypeAlias = dict[str, Register]


def layout(*tables: str) -> Layout:
    """The registers of tables: a line `address name access: field low-high, …` each. A field with
    `±` is signed. Of registers with equal names, the last one counts."""
    found: Layout = {}
    for line in filter(None, "\n".join(tables).splitlines()):
        head, _, rest = line.partition(":")
        address, name, access = head.split()
        fields: dict[str, Field] = {}
        for part in rest.split(","):
            field, bits = part.split()
            low, _, high = bits.removesuffix("±").partition("-")
            width = int(high or low) - int(low) + 1
            fields[field] = Field(name, int(low), width, bits.endswith("±"))
        found[name] = Register(name, int(address, 16), access, fields)
    return found


_FIRST = """
10 IHOLD_IRUN w: ihold 0-4, irun 8-12, iholddelay 16-19
11 TPOWERDOWN w: tpowerdown 0-7
12 TSTEP r: tstep 0-19
13 TPWMTHRS w: tpwmthrs 0-19
6A MSCNT r: mscnt 0-9
6B MSCURACT r: cur_a 0-8±, cur_b 16-24±
"""
_BY_UART = """
00 GCONF rw: i_scale_analog 0, internal_rsense 1, en_spreadcycle 2, shaft 3, index_otpw 4,\
 index_step 5, pdn_disable 6, mstep_reg_select 7, multistep_filt 8, test_mode 9
01 GSTAT rw: reset 0, drv_err 1, uv_cp 2
02 IFCNT r: ifcnt 0-7
03 SLAVECONF w: senddelay 8-11
05 OTP_READ r: otp_fclktrim 0-4, otp_ottrim 5, otp_internalrsense 6, otp_tbl 7,\
 otp_pwm_grad 8-11, otp_pwm_autograd 12, otp_tpwmthrs 13-15, otp_pwm_ofs 16, otp_pwm_reg 17,\
 otp_pwm_freq 18, otp_iholddelay 19-20, otp_ihold 21-22, otp_en_spreadcycle 23
07 FACTORY_CONF rw: fclktrim 0-4, ottrim 8-9
22 VACTUAL w: vactual 0-23±
6C CHOPCONF rw: toff 0-3, hstrt 4-6, hend 7-10, tbl 15-16, vsense 17, mres 24-27, intpol 28,\
 dedge 29, diss2g 30, diss2vs 31
6F DRV_STATUS r: otpw 0, ot 1, s2ga 2, s2gb 3, s2vsa 4, s2vsb 5, ola 6, olb 7, t120 8, t143 9,\
 t150 10, t157 11, cs_actual 16-20, stealth 30, stst 31
"""
_AUTOMATIC_PWM = """
70 PWMCONF rw: pwm_ofs 0-7, pwm_grad 8-15, pwm_freq 16-17, pwm_autoscale 18, pwm_autograd 19,\
 freewheel 20-21, pwm_reg 24-27, pwm_lim 28-31
71 PWM_SCALE r: pwm_scale_sum 0-7, pwm_scale_auto 16-24±
72 PWM_AUTO r: pwm_ofs_auto 0-7, pwm_grad_auto 16-23
"""
TMC2208 = layout(
    _FIRST,
    _BY_UART,
    _AUTOMATIC_PWM,
    "06 IOIN r: enn 0, ms1 2, ms2 3, diag 4, pdn_uart 6, step 7, sel_a 8, dir 9, version 24-31",
)
TMC2225 = TMC2208 | layout(
    "06 IOIN r: pdn_uart 1, spread 2, dir 3, enn 4, step 5, ms1 6, ms2 7, sel_a 8, version 24-31"
)
TMC2209 = TMC2208 | layout(
    """
06 IOIN r: enn 0, ms1 2, ms2 3, diag 4, pdn_uart 6, step 7, spread_en 8, dir 9, version 24-31
14 TCOOLTHRS w: tcoolthrs 0-19
40 SGTHRS w: sgthrs 0-7
41 SG_RESULT r: sg_result 0-9
42 COOLCONF w: semin 0-3, seup 5-6, semax 8-11, sedn 13-14, seimin 15
"""
)
_WAVE = """
60 MSLUT0 w: mslut0 0-31
61 MSLUT1 w: mslut1 0-31
62 MSLUT2 w: mslut2 0-31
63 MSLUT3 w: mslut3 0-31
64 MSLUT4 w: mslut4 0-31
65 MSLUT5 w: mslut5 0-31
66 MSLUT6 w: mslut6 0-31
67 MSLUT7 w: mslut7 0-31
68 MSLUTSEL w: w0 0-1, w1 2-3, w2 4-5, w3 6-7, x1 8-15, x2 16-23, x3 24-31
69 MSLUTSTART w: start_sin 0-7, start_sin90 16-23
"""
TMC2130 = layout(
    _FIRST,
    _WAVE,
    """
00 GCONF rw: i_scale_analog 0, internal_rsense 1, en_pwm_mode 2, enc_commutation 3, shaft 4,\
 diag0_error 5, diag0_otpw 6, diag0_stall 7, diag1_stall 8, diag1_index 9, diag1_onstate 10,\
 diag1_steps_skipped 11, diag0_int_pushpull 12, diag1_pushpull 13, small_hysteresis 14,\
 stop_enable 15, direct_mode 16, test_mode 17
01 GSTAT r: reset 0, drv_err 1, uv_cp 2
04 IOIN r: step 0, dir 1, dcen_cfg4 2, dcin_cfg5 3, drv_enn_cfg6 4, dco 5, version 24-31
14 TCOOLTHRS w: tcoolthrs 0-19
15 THIGH w: thigh 0-19
2D XDIRECT rw: coil_a 0-8±, coil_b 16-24±
33 VDCMIN w: vdcmin 0-22
6C CHOPCONF rw: toff 0-3, hstrt 4-6, hend 7-10, fd3 11, disfdcc 12, rndtf 13, chm 14, tbl 15-16,\
 vsense 17, vhighfs 18, vhighchm 19, sync 20-23, mres 24-27, intpol 28, dedge 29, diss2g 30
6D COOLCONF w: semin 0-3, seup 5-6, semax 8-11, sedn 13-14, seimin 15, sgt 16-22±, sfilt 24
6E DCCTRL w: dc_time 0-9, dc_sg 16-23
6F DRV_STATUS r: sg_result 0-9, fsactive 15, cs_actual 16-20, stallguard 24, ot 25, otpw 26,\
 s2ga 27, s2gb 28, ola 29, olb 30, stst 31
70 PWMCONF w: pwm_ampl 0-7, pwm_grad 8-15, pwm_freq 16-17, pwm_autoscale 18, pwm_symmetric 19,\
 freewheel 20-21
71 PWM_SCALE r: pwm_scale 0-7
72 ENCM_CTRL w: inv 0, maxspeed 1
73 LOST_STEPS r: lost_steps 0-19
""",
)
_WITH_SCALER = """
0B GLOBALSCALER w: globalscaler 0-7
6C CHOPCONF rw: toff 0-3, hstrt 4-6, hend 7-10, fd3 11, disfdcc 12, chm 14, tbl 15-16,\
 vhighfs 18, vhighchm 19, tpfd 20-23, mres 24-27, intpol 28, dedge 29, diss2g 30, diss2vs 31
6F DRV_STATUS r: sg_result 0-9, s2vsa 12, s2vsb 13, stealth 14, fsactive 15, cs_actual 16-20,\
 stallguard 24, ot 25, otpw 26, s2ga 27, s2gb 28, ola 29, olb 30, stst 31
"""
_MAIN_5160 = """
00 GCONF rw: recalibrate 0, faststandstill 1, en_pwm_mode 2, multistep_filt 3, shaft 4,\
 diag0_error 5, diag0_otpw 6, diag0_stall 7, diag1_stall 8, diag1_index 9, diag1_onstate 10,\
 diag1_steps_skipped 11, diag0_int_pushpull 12, diag1_poscomp_pushpull 13, small_hysteresis 14,\
 stop_enable 15, direct_mode 16, test_mode 17
01 GSTAT rw: reset 0, drv_err 1, uv_cp 2
04 IOIN r: refl_step 0, refr_dir 1, encb_dcen_cfg4 2, enca_dcin_cfg5 3, drv_enn 4,\
 enc_n_dco_cfg6 5, sd_mode 6, swcomp_in 7, version 24-31
09 SHORT_CONF w: s2vs_level 0-3, s2g_level 8-11, short_filter 16-17, shortdelay 18
0A DRV_CONF w: bbmtime 0-4, bbmclks 8-11, otselect 16-17, drvstrength 18-19, filt_isense 20-21
0C OFFSET_READ r: offset_b 0-7±, offset_a 8-15±
"""
_AUTOMATIC_SPI = _AUTOMATIC_PWM.replace("PWMCONF rw", "PWMCONF w")
TMC5160 = TMC2130 | layout(_WITH_SCALER, _MAIN_5160, _AUTOMATIC_SPI)
TMC2240 = TMC2130 | layout(
    _WITH_SCALER,
    _AUTOMATIC_PWM,
    """
00 GCONF rw: faststandstill 1, en_pwm_mode 2, multistep_filt 3, shaft 4, diag0_error 5,\
 diag0_otpw 6, diag0_stall 7, diag1_stall 8, diag1_index 9, diag1_onstate 10, diag0_pushpull 12,\
 diag1_pushpull 13, small_hysteresis 14, stop_enable 15, direct_mode 16
01 GSTAT rw: reset 0, drv_err 1, uv_cp 2, register_reset 3, vm_uvlo 4
70 PWMCONF rw: pwm_ofs 0-7, pwm_grad 8-15, pwm_freq 16-17, pwm_autoscale 18, pwm_autograd 19,\
 freewheel 20-21, pwm_meas_sd_enable 22, pwm_dis_reg_stst 23, pwm_reg 24-27, pwm_lim 28-31
71 PWM_SCALE r: pwm_scale_sum 0-9, pwm_scale_auto 16-24±
02 IFCNT r: ifcnt 0-7
03 SLAVECONF rw: slaveaddr 0-7, senddelay 8-11
04 IOIN r: step 0, dir 1, encb 2, enca 3, drv_enn 4, encn 5, uart_en 6, comp_a 8, comp_b 9,\
 comp_a1_a2 10, comp_b1_b2 11, output 12, ext_res_det 13, ext_clk 14, adc_err 15,\
 silicon_rv 16-18, version 24-31
0A DRV_CONF rw: current_range 0-1, slope_control 4-5
0B GLOBALSCALER rw: globalscaler 0-7
10 IHOLD_IRUN rw: ihold 0-4, irun 8-12, iholddelay 16-19, irundelay 24-27
50 ADC_VSUPPLY_AIN r: adc_vsupply 0-12, adc_ain 16-28
51 ADC_TEMP r: adc_temp 0-12
52 OTW_OV_VTH rw: overvoltage_vth 0-12, overtempprewarning_vth 16-28
69 MSLUTSTART w: start_sin 0-7, start_sin90 16-23, offset_sin90 24-31±
74 SG4_THRS rw: sg4_thrs 0-7, sg4_filt_en 8, sg4_angle_offset 9
75 SG4_RESULT r: sg4_result 0-9
76 SG4_IND r: sg4_ind_0 0-7, sg4_ind_1 8-15, sg4_ind_2 16-23, sg4_ind_3 24-31
""",
)
for _absent in ("XDIRECT", "VDCMIN", "DCCTRL", "ENCM_CTRL", "LOST_STEPS"):
    del TMC2240[_absent]
del TMC5160["ENCM_CTRL"]

# A TMC2660 has datagrams of 20 bits: the address is in the upper three, or two for DRVCTRL. An
# answer has 10 bits of one of three values, which RDSEL selects, and eight flags.
_FLAGS = "stallguard 0, ot 1, otpw 2, s2ga 3, s2gb 4, ola 5, olb 6, stst 7"
TMC2660 = layout(f"""
00 DRVCTRL w: mres 0-3, dedge 8, intpol 9
04 CHOPCONF w: toff 0-3, hstrt 4-6, hend 7-10, hdec 11-12, rndtf 13, chm 14, tbl 15-16
05 SMARTEN w: semin 0-3, seup 5-6, semax 8-11, sedn 13-14, seimin 15
06 SGCSCONF w: cs 0-4, sgt 8-14±, sfilt 16
07 DRVCONF w: rdsel 4-5, vsense 6, sdoff 7, ts2g 8-9, diss2g 10, slpl 12-13, slph 14-15, tst 16
10 READRSP@RDSEL0 r: mstep 10-19, {_FLAGS}
11 READRSP@RDSEL1 r: sg_result 10-19, {_FLAGS}
12 READRSP@RDSEL2 r: se 10-14, sg_high 15-19, {_FLAGS}
""")
