#!/usr/bin/env python3
"""Runs GenMC's tests, where their folder is given, under `irt check`.

    tests/peers/genmc.py GENMC/tests [--only correct/litmus] [--seconds 10] [--out table.md]

Each variant of `correct` must not be accused, each of `wrong` must be; where GenMC says how many
executions there are under RC11 the number is compared. The tests are compiled here, with
irt_virtual_module(), and nothing of them is kept. `./irt check` must have been called once.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parents[2]
BUILD = HERE / "build" / "peers" / "genmc"
CHECK = HERE / "build" / "development" / "lib" / "irt" / "irt-check"

# What the tests take from GenMC's own header, by what a checker of programs has.
HEADER = """#pragma once
#include <stdbool.h>
#include <stdlib.h>
#include <stdint.h>
#include <assert.h>
#include <pthread.h>
#ifdef __cplusplus
extern "C"
#endif
void __VERIFIER_assume(bool);
#define __VERIFIER_assert(x) assert(x)
#define __VERIFIER_error() abort()
#define __VERIFIER_loop_begin()
#define __VERIFIER_spin_start()
#define __VERIFIER_spin_end(x)
#define __VERIFIER_local_write(s) do { s; } while (0)
#define __VERIFIER_final_write(s) do { s; } while (0)
#define __VERIFIER_helped_CAS(c) do { c; } while (0)
#define __VERIFIER_helping_CAS(c) do { c; } while (0)
#define __VERIFIER_speculative_read(c) (c)
#define __VERIFIER_confirming_read(c) (c)
#define __VERIFIER_confirming_CAS(c) (c)
#define __VERIFIER_final_CAS(c) (c)
typedef pthread_t __VERIFIER_thread_t;
static inline pthread_t __VERIFIER_spawn(void *(*f)(void *), void *a) {
  pthread_t t; pthread_create(&t, 0, f, a); return t;
}
static inline pthread_t __VERIFIER_spawn_symmetric(void *(*f)(void *), void *a, pthread_t other) {
  (void)other; return __VERIFIER_spawn(f, a);
}
static inline void *__VERIFIER_join(pthread_t t) { void *r; pthread_join(t, &r); return r; }
#define __VERIFIER_join_symmetric(t) __VERIFIER_join(t)
"""

# Folders about what is no part of C: files that survive a crash, Linux's memory model.
FOREIGN = ("fs", "lkmm")


def first_line(path):
    try:
        return path.read_text().splitlines()
    except OSError:
        return []


def cases(tests, only):
    """(name, source, flags, whether it is right, executions that GenMC counts or None)"""
    for kind in ("correct", "wrong"):
        for folder in sorted((tests / kind).glob("*/*")):
            if folder.parent.name in FOREIGN or not str(folder.relative_to(tests)).startswith(only):
                continue
            variants = folder / "variants"
            sources = sorted(p for p in (variants if variants.is_dir() else folder).glob("*")
                             if p.suffix in (".c", ".cpp"))
            arguments = first_line(folder / "args.rc11.mo.in") or first_line(folder / "args.in") or [""]
            counts = " ".join(first_line(folder / "expected.rc11.mo.in")).split()
            for line, text in enumerate(arguments):
                flags = re.findall(r"-D\S+", text)
                for source in sources:
                    count = counts[min(line, len(counts) - 1)] if counts and kind == "correct" else None
                    name = str(source.relative_to(tests)) + (f" {' '.join(flags)}" if flags else "")
                    yield name, source, flags, kind == "correct", int(count) if count else None


def project(all_cases):
    lines = ["cmake_minimum_required(VERSION 3.25)", "project(peers LANGUAGES C CXX)",
             "find_package(irt REQUIRED)", "set(CMAKE_CXX_STANDARD 20)",
             "include_directories(BEFORE ${CMAKE_CURRENT_SOURCE_DIR}/shim)",
             "add_custom_target(everything ALL)"]
    for number, (_, source, flags, _, _) in enumerate(all_cases):
        lines.append(f'irt_virtual_module(t{number} SOURCES "{source}" OPTIONS -O0 -w \"SHELL:-include stdint.h\" \"SHELL:-include limits.h\" {" ".join(flags)})')
        lines.append(f"add_dependencies(everything t{number})")
    (BUILD / "shim").mkdir(parents=True, exist_ok=True)
    (BUILD / "shim" / "genmc.h").write_text(HEADER)
    (BUILD / "shim" / "lkmm.h").write_text("#error \"Linux's memory model is not C's\"\n")
    (BUILD / "CMakeLists.txt").write_text("\n".join(lines) + "\n")
    for old in (BUILD / "build").glob("t*.so"):  # perhaps of another test of that number
        old.unlink()
    log = open(BUILD / "build.log", "w")
    subprocess.run(["cmake", "-G", "Ninja", "-S", BUILD, "-B", BUILD / "build",
                    f"-DCMAKE_PREFIX_PATH={HERE / 'build' / 'development'}"],
                   stdout=log, stderr=log, check=True)
    subprocess.run(["ninja", "-k", "0", "-C", BUILD / "build", "everything"], stdout=log, stderr=log)


def run(number, name, seconds):
    module = BUILD / "build" / f"t{number}.so"
    if not module.exists():
        return {"verdict": "does not compile"}
    result = BUILD / "result.json"
    result.unlink(missing_ok=True)
    try:
        ran = subprocess.run([CHECK, "--program", name, "--module", module, "--json", result, "--threads",
                              "15", "--no-leaks", "--seconds", str(seconds), "--quiet"],
                             capture_output=True, text=True, timeout=seconds + 120)
    except subprocess.TimeoutExpired:
        return {"verdict": "hangs"}
    if not result.exists():
        return {"verdict": (ran.stderr.strip().splitlines() or ["?"])[-1]}
    j = json.loads(result.read_text())
    searches = j["searches"]
    whole = [s for s in searches if s["search"] == "exhaustive" and s["finished"]]
    found = [s["finding"]["kind"] for s in searches if "finding" in s]
    return {"verdict": found[0] if found else "whole" if whole else "not whole",
            "found": bool(found), "complete": whole[-1]["complete"] if whole else None,
            "seconds": sum(s["seconds"] for s in searches), "incomplete": searches[-1]["incomplete"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("tests", type=pathlib.Path)
    parser.add_argument("--only", default="", help="a folder of it")
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--out", type=pathlib.Path)
    options = parser.parse_args()
    if not CHECK.exists():
        sys.exit("tests/peers/genmc.py: irt-check is not built; ./irt check builds it")
    all_cases = list(cases(options.tests.resolve(), options.only))
    project(all_cases)
    rows = []
    for number, (name, _, _, right, count) in enumerate(all_cases):
        result = run(number, name, options.seconds)
        if "found" not in result:
            state = "not run"
        elif result["found"] == right:
            state = "DIFFERS"
        elif not right or result["complete"] is None:
            state = "agrees" if not right else "not whole"
        elif count is None or count == result["complete"]:
            state = "same count" if count is not None else "agrees"
        else:
            state = "other count"
        rows.append((name, "correct" if right else "wrong", state, result["verdict"],
                     result.get("complete"), count, result.get("incomplete", "")))
        print(" | ".join(str(c) for c in rows[-1]), flush=True)
    folders = {}
    for row in rows:
        folder = "/".join(row[0].split("/")[:2])
        folders.setdefault(folder, {}).setdefault(row[2], []).append(row)
    states = ["same count", "agrees", "other count", "not whole", "DIFFERS", "not run"]
    table = ["| folder | " + " | ".join(states) + " |", "|---" * (len(states) + 1) + "|"]
    for folder, by in folders.items():
        table.append(f"| {folder} | " + " | ".join(str(len(by.get(s, []))) for s in states) + " |")
    print("\n".join(table))
    if options.out:
        options.out.write_text("\n".join(table) + "\n")
    sys.exit(any("DIFFERS" in by for by in folders.values()))


main()
