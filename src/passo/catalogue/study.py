"""Errors of studies."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus, bad_input

STUDY: Mapping[str, Entry] = {
    "study.no-files": bad_input(
        "file", "{value!r} matches no file", "Correct the path or the pattern in files"
    ),
    "study.no-settings": bad_input(
        "file", "{key} has no values, so the study has no case", "Add a value, or remove the key"
    ),
    "study.changed": bad_input(
        "file",
        "the file has changed since the study began",
        "Start the study again; it computes only what has changed",
    ),
    "study.busy": bad_input(
        "file", "another study is writing it", "Wait for its end, or choose another folder"
    ),
    "study.other-rows": bad_input(
        "file",
        "line {value} is not a row of a study",
        "Choose another folder, or delete the file",
    ),
    "study.cache": bad_input(
        "file", "cannot be used as a cache: {value}", "Name another file with --cache"
    ),
    "study.no-rows": bad_input(
        "file", "holds no results of a study", "Run `passo batch STUDY.toml --output` first"
    ),
    "study.halted": Entry(
        "machine",
        "the simulated print failed: {value}",
        "Report the file and the machine file",
        ExitStatus.MACHINE_FAULT,
    ),
    "study.crash": Entry(
        "file",
        "the process that computed this case ended by {value}, twice",
        "Raise --memory if it was killed by the system; else report the file",
        ExitStatus.MACHINE_FAULT,
    ),
    "study.timeout": Entry(
        "file",
        "the case took longer than {value} s",
        "Raise --timeout",
        ExitStatus.MACHINE_FAULT,
    ),
    "study.memory": Entry(
        "file",
        "the case needs more memory than a process may use",
        "Raise --memory",
        ExitStatus.MACHINE_FAULT,
    ),
    "study.no-process": Entry(
        "computer",
        "processes for the study end at their start, by {value}",
        "In a program, call passo.batch below `if __name__ == '__main__':`, or with jobs=0;"
        " else raise --memory",
        ExitStatus.MACHINE_FAULT,
    ),
    "study.package": Entry(
        "computer",
        "{value} is not installed",
        "Install it: pip install 'passo[cluster]'",
        ExitStatus.MACHINE_FAULT,
    ),
    "study.cluster": Entry(
        "computer",
        "the cluster at {value} cannot be used: {limit}",
        "Start its scheduler and its workers, with this version of Passo on each",
        ExitStatus.MACHINE_FAULT,
    ),
    "study.results": Entry(
        "file",
        "the results cannot be written: {value}",
        "Check the free space and the permissions, then start the study again: it continues",
        ExitStatus.BAD_INPUT,
    ),
}
