#!/usr/bin/env python3
"""Runs CDSChecker's benchmarks, where their folder is given, under `irt check`.

    tests/peers/cdschecker.py FOLDER... [--only ms-queue] [--seconds 20] [--out table.md]

FOLDER is a checkout of model-checker-benchmarks (CDSChecker) or of cdschecker-benchmarks (CDSSpec,
the same programs with more clients). What is known to be wrong must be accused, the rest must not
be. Where CDSSpec says how a known bug comes back, that is tried too. The programs are compiled
here, with irt_virtual_module(), and nothing of them is kept. `./irt check` must have been called
once.
"""

import argparse
import json
import pathlib
import re
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parents[2]
BUILD = HERE / "build" / "peers" / "cdschecker"
DEVELOPMENT = HERE / "build" / "development"

# What the benchmarks take from CDSChecker. Its threads return nothing, and its plain accesses are
# calls; the names of <atomic> are global there, and a condition variable waits with a bare mutex.
HEADERS = {
    "threads.h": """#pragma once
#include <pthread.h>
#include <sched.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
typedef void (*thrd_start_t)(void *);
struct peers_thread { thrd_start_t start; void *argument; pthread_t thread; };
typedef struct { struct peers_thread *priv; } thrd_t;
#ifdef __cplusplus
inline thread_local struct peers_thread *peers_self;
#else
__attribute__((weak)) _Thread_local struct peers_thread *peers_self;
#endif
static inline void *peers_start(void *given) {
  struct peers_thread *me = (struct peers_thread *)given;
  peers_self = me;
  me->start(me->argument);
  return 0;
}
static inline int thrd_create(thrd_t *t, thrd_start_t start, void *argument) {
  struct peers_thread *made = (struct peers_thread *)malloc(sizeof *made);
  made->start = start;
  made->argument = argument;
  t->priv = made;  // before it runs: it may look for itself
  return pthread_create(&made->thread, 0, peers_start, made);
}
static inline int thrd_join(thrd_t t) { return pthread_join(t.priv->thread, 0); }
static inline thrd_t thrd_current(void) { thrd_t t = {peers_self}; return t; }
static inline void thrd_yield(void) { sched_yield(); }
""",
    "librace.h": "#pragma once\n#include <stdint.h>\n" + "".join(
        f"static inline void store_{b}(void *p, uint{b}_t v) {{ *(uint{b}_t *)p = v; }}\n"
        f"static inline uint{b}_t load_{b}(const void *p) {{ return *(const uint{b}_t *)p; }}\n"
        for b in (8, 16, 32, 64)),
    "model-assert.h": """#pragma once
#include <assert.h>
#undef NDEBUG
#define MODEL_ASSERT(x) assert(x)
""",
    "stdatomic.h": """#pragma once
#ifndef __cplusplus
#include_next <stdatomic.h>
#else
#include <atomic>
""" + "".join(f"using std::{name};\n" for name in (
        "atomic", "atomic_int", "atomic_uint", "atomic_bool", "memory_order", "memory_order_relaxed",
        "memory_order_acquire", "memory_order_release", "memory_order_acq_rel", "memory_order_seq_cst",
        "atomic_thread_fence", "atomic_init")) + "#endif\n",
    "condition_variable": """#pragma once
#include_next <condition_variable>
#include <mutex>
namespace std {
struct peers_condition_variable : condition_variable {
  void wait(mutex &m) {
    unique_lock<mutex> lock(m, adopt_lock);
    condition_variable::wait(lock);
    (void)lock.release();
  }
};
}
#define condition_variable peers_condition_variable
""",
}
MAIN = 'int user_main(int, char **);\nint main(int argc, char **argv) { return user_main(argc, argv); }\n'

# folder/client: (what is known, whether it must be accused)
KNOWN = {
    "chase-lev-deque": ("bug: steal() may see the new array before it is filled", True),
    "chase-lev-deque-bugfix": ("fixed", False),
    "spsc-queue": ("bug: the signal is lost, the consumer sleeps", True),
    "spsc-bugfix": ("fixed", False),
    "ms-queue": ("right with this client; two orders are too weak for others", False),
}
# folder, client, the bug, file, (text, its replacement): how CDSSpec's suite says a bug comes back.
BACK = [
    ("chase-lev-deque-bugfix", "testcase1", "known bug 1", "deque.c",
     r"(atomic_load_explicit\(&q->array, )memory_order_acquire", r"\1memory_order_relaxed"),
    ("ms-queue", "testcase4", "known bug 1", "queue.c",
     r"(atomic_store_explicit\(&q->nodes\[node\]\.next, tmp, )release", r"\1relaxed"),
    ("ms-queue", "testcase2", "known bug 2", "queue.c",
     r"(tail = atomic_load_explicit\(&q->tail, )acquire(\);\s*// \w+-injection-#8)", r"\1relaxed\2"),
]


class Case:
    def __init__(self, suite, folder, client, sources, flags="", edit=None, known=None):
        self.suite, self.folder, self.client, self.sources = suite, folder, client, sources
        self.flags, self.edit = flags, edit
        self.known, self.wrong = known or KNOWN.get(folder, ("right", False))
        self.name = f"{folder}/{client}"


def cases(suite):
    for folder in sorted(p.name for p in suite.iterdir() if (p / "Makefile").exists()):
        sources = sorted(p.name for p in (suite / folder).iterdir()
                         if p.suffix in (".c", ".cc") and "relacy" not in p.name)
        clients = [s for s in sources if re.match(r"(main|testcase)", s)]
        rest = [s for s in sources if s not in clients]
        # mpmc-queue's Makefile makes several programs of one source.
        made = re.findall(r"^(\S+): CPPFLAGS \+= (.*)$", (suite / folder / "Makefile").read_text(), re.M)
        if made:
            for client, flags in made:
                yield Case(suite, folder, client, sources, flags)
        elif clients:
            for client in clients:
                yield Case(suite, folder, client.split(".")[0], [client] + rest)
        else:
            yield Case(suite, folder, rest[0].split(".")[0], rest)
        for where, client, bug, file, text, replacement in BACK:
            if where == folder and any(c.startswith(client + ".") for c in clients):
                source = [c for c in clients if c.startswith(client + ".")]
                yield Case(suite, folder, f"{client}, {bug}", source + rest, "",
                           (file, text, replacement), ("bug, brought back", True))


def copied(case, number):
    """The program, in a folder of its own, as C++20 or C17 takes it."""
    to = BUILD / "programs" / str(number)
    shutil.copytree(case.suite / case.folder, to)
    for path in to.iterdir():
        if path.suffix not in (".c", ".cc", ".h"):
            continue
        text = path.read_text()
        if path.name == "mpmc-queue.h":  # C++11 takes no `false` for a null pointer
            text = text.replace("return false;", "return NULL;")
        if case.edit and case.edit[0] == path.name:
            text, count = re.subn(case.edit[1], case.edit[2], text)
            if count != 1:
                sys.exit(f"tests/peers/cdschecker.py: {case.name}: {count} places to edit, not 1")
        path.write_text(text)
    with open(to / case.sources[0], "a") as client:
        client.write(MAIN.replace("int user_main(int, char **);\n", ""))
    return [to / s for s in case.sources]


def project(all_cases):
    shutil.rmtree(BUILD / "programs", ignore_errors=True)
    lines = ["cmake_minimum_required(VERSION 3.25)", "project(peers LANGUAGES C CXX)",
             "find_package(irt REQUIRED)", "set(CMAKE_CXX_STANDARD 20)", "set(CMAKE_C_STANDARD 17)",
             "include_directories(BEFORE ${CMAKE_CURRENT_SOURCE_DIR}/shim)",
             "add_custom_target(everything ALL)"]
    for number, case in enumerate(all_cases):
        sources = " ".join(f'"{s}"' for s in copied(case, number))
        lines.append(f'irt_virtual_module(t{number} SOURCES {sources} OPTIONS -O0 -g -w -fpermissive '
                     f'-I{case.suite / "include"} {case.flags})')
        lines.append(f"add_dependencies(everything t{number})")
    (BUILD / "shim").mkdir(parents=True, exist_ok=True)
    for name, text in HEADERS.items():
        (BUILD / "shim" / name).write_text(text)
    (BUILD / "CMakeLists.txt").write_text("\n".join(lines) + "\n")
    for old in (BUILD / "build").glob("t*.so"):  # perhaps of another program of that number
        old.unlink()
    with open(BUILD / "build.log", "w") as log:
        subprocess.run(["cmake", "-G", "Ninja", "-S", BUILD, "-B", BUILD / "build",
                        f"-DCMAKE_PREFIX_PATH={DEVELOPMENT}"], stdout=log, stderr=log, check=True)
        subprocess.run(["ninja", "-k", "0", "-C", BUILD / "build", "everything"], stdout=log, stderr=log)


def run(number, name, seconds):
    module = BUILD / "build" / f"t{number}.so"
    if not module.exists():
        return {"verdict": "does not compile"}
    result = BUILD / "result.json"
    result.unlink(missing_ok=True)
    try:
        ran = subprocess.run([DEVELOPMENT / "lib" / "irt" / "irt-check", "--program", name, "--module",
                              module, "--json", result, "--no-leaks", "--seconds", str(seconds),
                              "--quiet"], capture_output=True, text=True, timeout=seconds + 120)
    except subprocess.TimeoutExpired:
        return {"verdict": "hangs"}
    (BUILD / f"t{number}.txt").write_text(ran.stdout + ran.stderr)
    if not result.exists():
        return {"verdict": (ran.stderr.strip().splitlines() or ["?"])[-1]}
    searches = json.loads(result.read_text())["searches"]
    whole = [s for s in searches if s["search"] == "exhaustive" and s["finished"]]
    found = [s["finding"]["kind"] for s in searches if "finding" in s]
    return {"verdict": found[0] if found else "whole" if whole else "not whole", "found": bool(found),
            "executions": sum(s["executions"] for s in searches),
            "seconds": sum(s["seconds"] for s in searches)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, nargs="+")
    parser.add_argument("--only", default="", help="a benchmark, or one client of it")
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--out", type=pathlib.Path)
    options = parser.parse_args()
    if not (DEVELOPMENT / "lib" / "irt" / "irt-check").exists():
        sys.exit("tests/peers/cdschecker.py: irt-check is not built; ./irt check builds it")
    all_cases = [c for f in options.folder for c in cases(f.resolve()) if options.only in c.name]
    project(all_cases)
    table = ["| benchmark | known | verdict | | executions | seconds |", "|---|---|---|---|---|---|"]
    differs = False
    for number, case in enumerate(all_cases):
        result = run(number, case.name, options.seconds)
        if "found" not in result:
            state = "not run"
        elif result["found"] != case.wrong:
            state = "DIFFERS" if result["found"] or result["verdict"] == "whole" else "not whole"
        else:
            state = "agrees" if result["found"] or result["verdict"] == "whole" else "not whole"
        differs |= state == "DIFFERS"
        table.append(f"| {case.name} | {case.known} | {result['verdict']} | {state} | "
                     f"{result.get('executions', '')} | {result.get('seconds', 0):.1f} |")
        print(table[-1], flush=True)
    if options.out:
        options.out.write_text("\n".join(table) + "\n")
    sys.exit(differs)


main()
