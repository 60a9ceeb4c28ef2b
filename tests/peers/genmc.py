#!/usr/bin/env python3
"""Runs GenMC's tests, where their folder is given, under `irt check`.

    tests/peers/genmc.py GENMC/tests [--only correct/litmus] [--seconds 10] [--out table.md]

Each variant of `correct` must not be accused, each of `wrong` must be; where GenMC says how many
executions there are under RC11 the number is compared. The tests are compiled here, with
irt_virtual_module(), and nothing of them is kept. `./irt check` must have been called once.
"""

import re

import peers

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


def main():
    options = peers.arguments(__doc__, "a folder of it", 10)
    all_cases = list(cases(options.folder.resolve(), options.only))
    project = peers.Project("genmc", {
        "genmc.h": HEADER, "lkmm.h": "#error \"Linux's memory model is not C's\"\n"})
    for number, (_, source, flags, _, _) in enumerate(all_cases):
        project.add(f"t{number}", [source], '-O0 -w "SHELL:-include stdint.h" '
                    f'"SHELL:-include limits.h" {" ".join(flags)}')
    project.build()
    folders = {}
    for number, (name, _, _, right, count) in enumerate(all_cases):
        result = project.check(f"t{number}", name, options.seconds)
        state = peers.judged(result, not right)
        if state == "agrees" and right and count is not None:
            state = "same count" if count == result["complete"] else "other count"
        print(" | ".join(str(c) for c in (
            name, "correct" if right else "wrong", state, result["verdict"], result.get("complete"),
            count, result.get("incomplete", ""))), flush=True)
        by = folders.setdefault("/".join(name.split("/")[:2]), {})
        by[state] = by.get(state, 0) + 1
    states = ["same count", "agrees", "other count", "not whole", "DIFFERS", "not run"]
    table = ["| folder | " + " | ".join(states) + " |", "|---" * (len(states) + 1) + "|"]
    for folder, by in folders.items():
        table.append(f"| {folder} | " + " | ".join(str(by.get(s, 0)) for s in states) + " |")
    print("\n".join(table))
    peers.finish(table, options.out, any("DIFFERS" in by for by in folders.values()))


main()
