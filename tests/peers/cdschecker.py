#!/usr/bin/env python3
"""Runs CDSChecker's benchmarks, where their folder is given, under `irt check`.

    tests/peers/cdschecker.py FOLDER... [--only ms-queue] [--seconds 20] [--out table.md]

FOLDER is a checkout of model-checker-benchmarks (CDSChecker) or of cdschecker-benchmarks (CDSSpec,
the same programs with more clients). What is known to be wrong must be accused, the rest must not
be. Where CDSSpec says how a known bug comes back, that is tried too. The programs are compiled
here, with irt_virtual_module(), and nothing of them is kept. `./irt check` must have been called
once.
"""

import re
import shutil

import peers

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


def copied(case, to):
    """The program, in a folder of its own, as C++20 or C17 takes it."""
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
                peers.stop(f"{case.name}: {count} places to edit, not 1")
        path.write_text(text)
    with open(to / case.sources[0], "a") as client:
        client.write("int main(int argc, char **argv) { return user_main(argc, argv); }\n")
    return [to / s for s in case.sources]


def main():
    options = peers.arguments(__doc__, "a benchmark, or one client of it", 20, nargs="+")
    all_cases = [c for f in options.folder for c in cases(f.resolve()) if options.only in c.name]
    project = peers.Project("cdschecker", HEADERS)
    for number, case in enumerate(all_cases):
        project.add(f"t{number}", copied(case, project.folder / "programs" / str(number)),
                    f'-O0 -g -w -fpermissive -I{case.suite / "include"} {case.flags}')
    project.build()
    table, differs = peers.TABLE[:], False
    for number, case in enumerate(all_cases):
        result = project.check(f"t{number}", case.name, options.seconds)
        state = peers.judged(result, case.wrong)
        differs |= state == "DIFFERS"
        peers.add_row(table, case.name, case.known, result, state)
    peers.finish(table, options.out, differs)


main()
