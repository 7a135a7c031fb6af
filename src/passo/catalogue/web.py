"""Errors of requests to the web interface, of uploads and of consoles."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus, bad_input


def _web(says: str, action: str) -> Entry:
    return Entry("web", says, action, ExitStatus.USAGE)


WEB: Mapping[str, Entry] = {
    "web.invalid": _web(
        "the {where} of the request is not valid at {pointer!r}: {value}",
        "Correct it as the API reference describes it",
    ),
    "web.malformed": _web(
        "the request cannot be read: {value}", "Correct it as the API reference describes it"
    ),
    "web.media-type": _web(
        "the body of the request is {value!r}: expected {limit}", "Set its Content-Type"
    ),
    "web.not-found": _web("there is no {value}", "Get the list first, then use a name from it"),
    "web.method": _web(
        "{value} is not possible here: expected {limit}", "Use one of these methods"
    ),
    "web.too-large": _web(
        "the body of the request is larger than {limit} bytes", "Send less at once"
    ),
    "web.log-in": _web(
        "this needs a log-in or an API key", "Log in, or send a key in the header X-Api-Key"
    ),
    "web.role": _web(
        "{value} may not do that: it needs the role {limit}",
        "Log in as an account with that role, or ask the administrator",
    ),
    "web.host": _web(
        "the request is for the host {value!r}, which is not a name of this printer",
        "Use its IP address, or start with --http-name NAME",
    ),
    "web.announce-loopback": _web(
        "the web interface is not announced: only this computer reaches it at {value}",
        "Start with --http 0.0.0.0:4000, or without --announce",
    ),
    "web.origin": _web(
        "the request comes from another web page: {value}",
        "Use the printer's own page; a script sends an API key in the header X-Api-Key",
    ),
    "web.too-many": _web(
        "there were too many attempts to log in: the next one may come in {limit} s",
        "Wait, then try again",
    ),
    "web.password": _web(
        "this needs the password again, entered within the last {limit} minutes",
        "Confirm the log-in with the password",
    ),
    "web.credentials": _web("the name or the password is wrong", "Check both, then try again"),
    "web.code": _web(
        "the one-time code is wrong", "Copy it from where `passo serve` has printed it"
    ),
    "web.pairing": _web(
        "the one-time code is wrong, used, or older than {limit} minutes",
        "Let an administrator of the printer make a new one",
    ),
    "web.no-administrator": _web(
        "this needs a password, and there is no account yet",
        "Create the administrator first",
    ),
    "web.set-up": _web("there is an administrator already", "Log in"),
    "web.account-exists": _web("there is an account {value} already", "Choose another name"),
    "web.last-administrator": _web(
        "{value} is the last administrator", "Make another account an administrator first"
    ),
    "web.accounts": _web(
        "the accounts cannot be used: {value}",
        "Check the folder of --state, its permissions and the free space on the disk",
    ),
    "web.scripts": _web(
        "{limit} scripts of this client are running already", "Wait for their answers"
    ),
    "web.slow": _web(
        "the body of the request did not arrive within {limit} s",
        "Check the network, then try again",
    ),
    "web.unreachable": _web(
        "{value} cannot be reached: {limit}", "Check the address, and that `passo serve` runs"
    ),
    "web.program": Entry(
        "web",
        "an unexpected fault of the program: {value}",
        "Report it, with the log of the printer",
        ExitStatus.MACHINE_FAULT,
    ),
    "upload.binary": bad_input(
        "file",
        "is binary G-code, which is not read here",
        'Switch off "Supports binary G-code" in the slicer\'s printer settings, and slice again',
    ),
    "upload.kind": bad_input(
        "file", "is not a G-code file: expected {limit}", "Slice the model and upload its G-code"
    ),
    "upload.content": bad_input(
        "file", "does not contain G-code: {value}", "Slice the model and upload its G-code"
    ),
    "upload.malformed": bad_input(
        "upload", "the request cannot be read: {value}", "Correct it and send it again"
    ),
    "upload.checksum": bad_input(
        "upload",
        "the received file has the SHA-256 {value}, not {limit}, and is not stored",
        "Send the file again",
    ),
    "upload.slow": bad_input(
        "upload",
        "only {value} bytes arrived within {limit} s",
        "Check the network, then send the file again",
    ),
    "upload.too-many": bad_input(
        "upload", "{limit} files are being uploaded already", "Wait until one of them is complete"
    ),
    "upload.offset": bad_input(
        "upload",
        "the upload continues at byte {limit}, not at {value}",
        "Query the offset of the upload, and send the bytes from there",
    ),
    "console.unopened": Entry(
        "console",
        "{axis} cannot be opened: {value}",
        "Check the name, its permissions, and that no other program has it",
        ExitStatus.USAGE,
    ),
    "console.not-installed": Entry(
        "console",
        "{axis} needs {value}, which is not installed",
        "Install Passo with its web interface: passo[web]",
        ExitStatus.USAGE,
    ),
}
