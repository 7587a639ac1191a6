#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Failures of JUnit files as annotations: workflow commands of GitHub Actions on stdout, and a code
quality report of GitLab."""
import argparse
import hashlib
import json
import pathlib
import xml.etree.ElementTree


def escape_data(text):
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def escape_property(text):
    return escape_data(text).replace(":", "%3A").replace(",", "%2C")


def failures(path):
    """(group, name, message, file or None, line) of each failed case."""
    for case in xml.etree.ElementTree.parse(path).getroot().iter("testcase"):
        failure = case.find("failure")
        if failure is not None:
            yield (case.get("classname"), case.get("name"), failure.get("message") or "it failed",
                   case.get("file"), int(case.get("line") or 1))


def annotation(group, name, message, file, line):
    title = escape_property(f"{group}: {name}")
    return f"::error file={escape_property(file)},line={line},title={title}::{escape_data(message)}"


def quality_entry(group, name, message, file, line):
    fingerprint = hashlib.sha256(f"{group}\n{name}".encode()).hexdigest()
    return {"description": f"{group}: {name}: {message}", "check_name": group,
            "fingerprint": fingerprint, "severity": "major",
            "location": {"path": file, "lines": {"begin": line}}}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("junit", nargs="+", type=pathlib.Path, help="files that are not there are "
                        "left out")
    parser.add_argument("--file", required=True, help="the file of failures that name none: the "
                        "renderer's program")
    parser.add_argument("--code-quality", type=pathlib.Path, required=True,
                        help="the report for GitLab, to be written")
    parser.add_argument("--accepted", action="append", type=pathlib.Path, default=[],
                        help="a JUnit file whose failures were accepted")
    options = parser.parse_args()
    found = []
    for path in options.junit:
        if path.exists() and path not in options.accepted:
            found += [(group, name, message, file or options.file, line)
                      for group, name, message, file, line in failures(path)]
    for failure in found:
        print(annotation(*failure))
    options.code_quality.write_text(json.dumps([quality_entry(*failure) for failure in found],
                                               indent=1) + "\n")


if __name__ == "__main__":
    main()
