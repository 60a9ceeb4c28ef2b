#!/usr/bin/env python3
"""Runs Relacy's own examples and tests, where its folder is given, under `irt check`.

    tests/peers/relacy.py FOLDER [--only peterson] [--seconds 20] [--out table.md]

FOLDER is a checkout of dvyukov/relacy. The programs are translated by their types only: rl::atomic
is std::atomic, rl::var a plain variable, and a test suite a main() that starts its threads. What a
suite expects stands in its type, or in the comment above it; what it says will go wrong must be
accused, and of that, and the rest must not be. A file is compiled once, with irt_virtual_module(),
and the suite is chosen by main's argument; nothing is kept. `./irt check` must have been called once.
"""

import pathlib
import re

import peers

# What stands for Relacy. Its `$` is where a call stands, and of no use here. Plain variables Relacy
# does not see and does not interrupt: where they only count, they are `unseen`, relaxed atomics. Java's
# and .NET's variables are the atomics that Relacy makes of them.
INCLUDES = """errno.h linux/futex.h pthread.h sched.h semaphore.h stdint.h stdlib.h sys/syscall.h unistd.h
atomic chrono climits condition_variable cstddef cstdio iostream map mutex shared_mutex thread utility
vector"""
SHIM = r"""#pragma once
INCLUDES
#undef NDEBUG
#include <cassert>
namespace rl {
struct debug_info {};
using std::memory_order, std::lock_guard, std::scoped_lock;
#define RL_ORDER(o) inline constexpr memory_order mo_##o = memory_order::o, memory_order_##o = mo_##o;
RL_ORDER(relaxed) RL_ORDER(consume) RL_ORDER(acquire) RL_ORDER(release) RL_ORDER(acq_rel)
RL_ORDER(seq_cst)

template <class T>
struct atomic : std::atomic<T> {
  using base = std::atomic<T>;
  using base::base, base::operator=, base::load, base::store;
  atomic& operator()(debug_info) { return *this; }
  const atomic& operator()(debug_info) const { return *this; }
  T load(memory_order o, debug_info) const { return base::load(o); }
  void store(T value, memory_order o, debug_info) { base::store(value, o); }
  template <class... O>
  bool compare_exchange(T& old, T value, O... o) {
    return base::compare_exchange_strong(old, value, o...);
  }
#define RL_FETCH(name, sign)                                                               \
  template <class U>                                                                       \
  T name(U by, memory_order o = mo_seq_cst) {                                              \
    if constexpr (requires(base& b) { b.name(by); }) return base::name(by, o);             \
    else                                                                                   \
      for (T old = base::load(mo_relaxed);;)                                               \
        if (base::compare_exchange_strong(old, old sign by, o, mo_relaxed)) return old;    \
  }
  RL_FETCH(fetch_add, +) RL_FETCH(fetch_sub, -)
};
struct atomic_flag : std::atomic_flag {
  using std::atomic_flag::test_and_set, std::atomic_flag::clear;
  bool test_and_set(memory_order o, debug_info) { return test_and_set(o); }
  void clear(memory_order o, debug_info) { clear(o); }
};
inline auto atomic_thread_fence(debug_info) { return std::atomic_thread_fence; }
template <class... I>
void atomic_thread_fence(memory_order o, I...) { std::atomic_thread_fence(o); }

template <class T>
struct var {
  T value;
  var() = default;
  var(T v) : value(v) {}
  var& operator()(debug_info) { return *this; }
  T load() const { return value; }
  void store(T v) { value = v; }
  operator T() const { return value; }
  T operator->() const { return value; }
  T operator=(T v) { return value = v; }
  T operator+=(auto v) { return value += v; }
  T operator-=(auto v) { return value -= v; }
  T operator++() { return ++value; }
  T operator--() { return --value; }
};
template <class T, memory_order loads, memory_order stores>
struct ordered {
  std::atomic<T> value;
  ordered& operator()(debug_info) { return *this; }
  operator T() const { return value.load(loads); }
  T operator=(T v) { return value.store(v, stores), v; }
  T operator=(const ordered& v) { return *this = T(v); }
  T operator+=(T v) { return value.fetch_add(v, stores) + v; }
};
template <class T> using unseen = ordered<T, mo_relaxed, mo_relaxed>;
template <class T> using jvar = unseen<T>;
template <class T> using nvar = unseen<T>;
template <class T> using jvolatile = ordered<T, mo_seq_cst, mo_seq_cst>;
template <class T> using nvolatile = ordered<T, mo_acquire, mo_release>;
struct Interlocked {
  static auto Exchange(auto& a, auto v, debug_info) {
    const auto old = a.value.exchange(v);
    std::atomic_thread_fence(mo_seq_cst);  // .NET's are full fences
    return old;
  }
};

template <class M>
struct lockable : M {
  void lock(debug_info = {}) { M::lock(); }
  bool try_lock(debug_info = {}) { return M::try_lock(); }
  void unlock(debug_info = {}) { M::unlock(); }
};
using mutex = lockable<std::mutex>;
using recursive_mutex = lockable<std::recursive_mutex>;
template <class M>
struct unique_lock : std::unique_lock<M> {
  unique_lock(M& m, debug_info) : std::unique_lock<M>(m) {}
};
struct condition_variable : std::condition_variable {
  void wait(mutex& m, debug_info = {}) {
    std::unique_lock<std::mutex> lock(m, std::adopt_lock);
    std::condition_variable::wait(lock);
    (void)lock.release();
  }
  void wait(mutex& m, auto holds, debug_info) { while (!holds()) wait(m); }
  void notify_one(debug_info = {}) { std::condition_variable::notify_one(); }
  void notify_all(debug_info = {}) { std::condition_variable::notify_all(); }
};
struct condition_variable_any : std::condition_variable_any {
  void wait_for(auto& m, int time, debug_info) {
    std::condition_variable_any::wait_for(m, std::chrono::milliseconds(time));
  }
  void notify_all(debug_info) { std::condition_variable_any::notify_all(); }
};
struct thread : std::thread {
  thread() = default;
  template <class F> thread(F f, debug_info) : std::thread(f) {}
  template <class F, class... A> thread(F f, A... a) : std::thread(f, a...) {}
};
struct dyn_thread : std::thread {
  void start(void* (*f)(void*), void* argument) { std::thread(f, argument).swap(*this); }
};
inline thread_local int self;
template <class T>
struct thread_local_var {
  T values[16] = {};
  T& operator()(debug_info) { return values[self]; }
  T get(debug_info) const { return values[self]; }
  void set(T v, debug_info) { values[self] = v; }
};
struct backoff { void yield(debug_info) { std::this_thread::yield(); } };
void yield(auto, auto) { std::this_thread::yield(); }
inline unsigned rand(unsigned below) { return unsigned(::rand()) % below; }
inline size_t hash_ptr(const void* p, size_t size) { return uintptr_t(p) / 16 % size; }
inline int timedwait(pthread_cond_t* c, pthread_mutex_t* m) {
  const timespec soon = {0, 1};
  return pthread_cond_timedwait(c, m, &soon);
}
inline int futex(atomic<int>* word, int what, int value) {
  const long got = syscall(SYS_futex, word, what, value, nullptr, nullptr, 0);
  return got < 0 ? errno : int(got);
}

enum test_result_e { RESULTS };
template <class T, int N, test_result_e result = test_result_success>
struct test_suite {
  struct params { static constexpr unsigned thread_count = N; };
  static constexpr unsigned count = N;
  void invariant() {}
  void before() {}
  void after() {}
};
template <class T>
int run() {
  T suite;
  suite.before();
  suite.invariant();
  std::vector<std::thread> threads;
  for (unsigned i = 0; i != T::count; ++i)
    threads.emplace_back([&suite, i] { self = int(i), suite.thread(i); });
  for (std::thread& t : threads) t.join();
  suite.invariant();
  suite.after();
  return 0;
}

inline namespace windows {  // Whatever can be waited for is looked at under one lock.
typedef int BOOL;
typedef long LONG;
enum { FALSE, TRUE };
enum : unsigned long { WAIT_OBJECT_0 = 0, WAIT_TIMEOUT = 258, INFINITE = -1ul, RL_INFINITE = -1ul };
struct object {
  enum { semaphore, automatic, manual, mutex, thread } kind;
  long count = 0, maximum = 1, pulses = 0, asleep = 0;  // asleep: they come first
  pthread_t owner = {};
  std::thread made = {};
  bool ready(long seen) const {
    return kind == mutex ? !count || owner == pthread_self() : count || pulses != seen;
  }
  void take(long seen) {
    if (kind == mutex) owner = pthread_self(), ++count;
    else if (kind != manual && pulses == seen) --count;
  }
};
typedef object* HANDLE;
inline std::mutex monitor;
inline std::condition_variable signalled;
inline bool signal(HANDLE o, long by, long* before = nullptr) {
  if (before) *before = o->count;
  if (o->kind == object::semaphore && o->count + by > o->maximum) return false;
  if (o->kind == object::semaphore) o->count += by;
  else if (o->kind == object::mutex) --o->count;
  else o->count = 1;
  signalled.notify_all();
  return true;
}
inline unsigned wait(auto& lock, unsigned n, HANDLE* o, bool all, unsigned long time) {
  unsigned first = 0;
  const long seen = o[0]->pulses;
  const auto there = [&] {
    unsigned ready = 0;
    for (unsigned i = n; i-- != 0;)
      if (o[i]->ready(n == 1 ? seen : o[i]->pulses)) ++ready, first = i;
    return all ? ready == n : ready != 0;
  };
  const bool alone = n == 1 && o[0]->kind < object::manual, sleeps = alone && time != 0;
  bool got = true;
  o[0]->asleep += sleeps;
  if (time == INFINITE) signalled.wait(lock, there);
  else if (time == 0) got = there() && (!alone || o[0]->count > o[0]->asleep);
  else got = signalled.wait_for(lock, std::chrono::milliseconds(time), there);
  o[0]->asleep -= sleeps;
  if (!got) return WAIT_TIMEOUT;
  if (all) first = 0;
  for (unsigned i = first; i != (all ? n : first + 1); ++i)
    o[i]->take(n == 1 ? seen : o[i]->pulses);
  return first;
}
inline unsigned WaitForMultipleObjects(unsigned n, HANDLE* o, bool all, unsigned long time) {
  if (o[0]->kind == object::thread) {
    for (unsigned i = 0; i != n; ++i) o[i]->made.join();
    return WAIT_OBJECT_0;
  }
  std::unique_lock lock(monitor);
  return wait(lock, n, o, all, time);
}
inline unsigned WaitForSingleObject(HANDLE o, unsigned long time, debug_info = {}) {
  return WaitForMultipleObjects(1, &o, true, time);
}
inline unsigned SignalObjectAndWait(HANDLE a, HANDLE b, unsigned long time, int) {
  std::unique_lock lock(monitor);
  return signal(a, 1), wait(lock, 1, &b, true, time);
}
inline HANDLE CreateSemaphore(void*, long count, long maximum, void*, debug_info = {}) {
  return new object{object::semaphore, count, maximum};
}
inline HANDLE CreateEvent(void*, int manual, int set, void*) {
  return new object{manual ? object::manual : object::automatic, set};
}
inline HANDLE CreateMutex(void*, int, void*) { return new object{object::mutex}; }
template <class R>
HANDLE started(R (*f)(void*), void* argument) {
  return new object{.kind = object::thread, .made = std::thread(f, argument)};
}
#define CreateThread(a, b, f, argument, ...) started<unsigned long>(f, argument)
#define _beginthreadex(a, b, f, argument, ...) started<unsigned>(f, argument)
struct CRITICAL_SECTION : std::recursive_mutex {};
struct SRWLOCK : std::shared_mutex {};
struct CONDITION_VARIABLE : std::condition_variable_any {};
#define RL_NOTHING(name) void name(auto...) {}
#define RL_LOCKED(name, what)                                                   \
  inline bool name(HANDLE o, long by = 1, long* b = nullptr, debug_info = {}) { \
    std::lock_guard l(monitor);                                                 \
    return what;                                                                \
  }
#define RL_CALLS(name, what) auto name(auto* o, debug_info = {}) { return o->what(); }
RL_NOTHING(InitializeCriticalSection) RL_NOTHING(InitializeCriticalSectionAndSpinCount)
RL_NOTHING(DeleteCriticalSection) RL_NOTHING(InitializeSRWLock) RL_NOTHING(DeleteSRWLock)
RL_NOTHING(InitializeConditionVariable) RL_NOTHING(DeleteConditionVariable)
RL_NOTHING(FlushProcessWriteBuffers)
RL_LOCKED(ReleaseSemaphore, signal(o, by, b)) RL_LOCKED(ReleaseMutex, signal(o, 1))
RL_LOCKED(SetEvent, signal(o, 1)) RL_LOCKED(ResetEvent, (o->count = 0, true))
RL_LOCKED(PulseEvent, (o->count || (++o->pulses, signalled.notify_all(), true)))
RL_CALLS(EnterCriticalSection, lock) RL_CALLS(LeaveCriticalSection, unlock)
RL_CALLS(TryEnterCriticalSection, try_lock) RL_CALLS(AcquireSRWLockExclusive, lock)
RL_CALLS(ReleaseSRWLockExclusive, unlock) RL_CALLS(WakeConditionVariable, notify_one)
RL_CALLS(WakeAllConditionVariable, notify_all)
inline void CloseHandle(HANDLE o, debug_info = {}) { delete o; }
void SleepConditionVariableCS(CONDITION_VARIABLE* c, auto* m, unsigned long time, int = 0) {
  if (time == INFINITE) c->wait(*m);
  else c->wait_for(*m, std::chrono::milliseconds(time));
}
typedef thread_local_var<void*> tls_slot;
}  // namespace windows
}  // namespace rl
using namespace rl::windows;

#define $ rl::debug_info()
#define VAR(x) x($)
#define VAR_T(...) rl::var<__VA_ARGS__>
#define TLS_T(...) rl::thread_local_var<__VA_ARGS__>
#define RL_ASSERT assert
#define RL_VERIFY assert
#define RL_UNTIL(x) assert(!(x) && "RL_UNTIL")
#define RL_HIST_IMPL(context, where, event) (void)event
#define RL_HIST_END()
#define RL_NEW new
#define RL_DELETE(p) delete p
#define RL_NEW_ARR(T, n) new T[n]
#define RL_DELETE_ARR(p) delete[] p
#define RL_STDCALL
#define RL_ATOMIC_FLAG_INIT {}
#define Sleep(time) std::this_thread::yield()
#define SwitchToThread std::this_thread::yield
#define SleepConditionVariableSRW SleepConditionVariableCS
#define TlsAlloc() (unsigned long)new tls_slot
#define TlsFree(s) delete (tls_slot*)(s)
#define TlsGetValue(s) ((tls_slot*)(s))->get($)
#define TlsSetValue(s, v) ((tls_slot*)(s))->set(v, $)
#define pthread_mutex_try_lock pthread_mutex_trylock
#define pthread_cond_init(c, a) pthread_cond_init(c, nullptr)
#define pthread_rwlock_init(l, a) pthread_rwlock_init(l, nullptr)
#define pthread_cond_timedwait(c, m, t) rl::timedwait(c, m)
#define pthread_yield sched_yield
#define futex(word, what, value, ...) rl::futex(word, what, value)
"""

# file: (text, its replacement)...: what is not the program, but Relacy's or the compiler's.
EDITS = {
    "example/examples/spsc_overwrite_queue.hpp": [  # its stdafx.h says so: RL_FORCE_SEQ_CST
        (r"memory_order_\w+", "memory_order_seq_cst")],
    "example/mpmc/mpmc.cpp": [(r"(?s)#ifdef RL_TEST.*?\n#endif", "")],
    "example/cli_ws_deque/cli_ws_deque.cpp": [(r"bool state ", "rl::unseen<bool> state ")],
    "example/java_ws_deque/java_ws_deque.cpp": [(r"bool state ", "rl::unseen<bool> state ")],
    "example/ws_deque/ws_deque.cpp": [(r"bool state ", "rl::unseen<bool> state ")],
    "example/stack/stack.cpp": [(r"int (produced|consumed)_count_;", r"rl::unseen<int> \1_count_;")],
    "example/proxy_collector/proxy_collector.cpp": [(r"int refcnt;", "long refcnt;")],  # no padding
    "example/eventcount/eventcount.cpp": [
        (r"(?s)#define HANDLE rl.*?CloseHandle\(\$\)\n", ""),
        (r"defined\(WIN32\) && defined\(_MSC_VER\)", "1"), (r"__declspec\(thread\)", "thread_local"),
        (r"_mm_mfence\(\)", "rl::atomic_thread_fence(rl::mo_seq_cst)")],
    "example/tbb_eventcount/eventcount.cpp": [(r"defined\(WIN32\) && defined\(_MSC_VER\)", "1")],
    "test/memory_order.hpp": [(r"int res;", "rl::unseen<int> res;")],
}
# What the types cannot say.
UNTRANSLATED = {
    "example/ws_deque2": "its reclamation counts on Relacy not interrupting it between plain accesses",
    "example/peterson/signaling_test": "its queue counts on Relacy not interrupting plain accesses",
    "test/jtest": "Java's collector and memory model",
    "test/ntest": ".NET's collector and memory model",
    "test/windows/test_FlushProcessWriteBuffers": "a fence that other threads execute is not C++",
    "test/futex/test_futex_intr": "a signal that ends the wait is not explored",
    "test/data_race/race_uninit_test": "Relacy leaves it out in C++20, where every atomic is initialised",
}
# Where the verdict is another than Relacy's, and why.
REASONS = {
    "example/examples/spsc_overwrite_queue_test()": "ABA: the consumer's compare-exchange stores a next "
        "that it read before the producer overwrote the ring and came to the same node again",
    "example/smr/smr_test": "hazard pointers are written and read relaxed, so that nothing orders the last "
        "read of a node before its deletion; Relacy does not ask that of atomic accesses",
    "example/stack/stack_test": "pop reads with relaxed what another thread initialises: that comes first",
    "test/atomic/atomic_use_after_scope_detected": "the end of a scope on the stack is not seen",
    "test/cxx11_thread/cxx11_thread_basic_ops_test": "C++ terminates where a joinable thread is destroyed",
    "test/memory_order/modification_order_test": "in C++20 a relaxed store of the same thread ends a release "
        "sequence, in C++11 it does not",
    "test/mutex/test_mutex_destuction": "libstdc++'s destructor of std::mutex is nothing that could be seen",
    "test/mutex/test_mutex_leak": "a std::mutex that is free holds no resource in libstdc++",
    "test/scheduler/livelock_test": "Relacy asks a loop to yield; here the other thread does go on",
}
# What is expected: what it may be accused of; whatever is not here, of anything.
ACCUSED = {
    "data race": ["data race"], "deadlock": ["deadlock"], "livelock": ["livelock"],
    "access to freed memory": ["use after free", "use after return"], "memory leak": ["memory leak"],
    "user assert failed": ["failure"], "until condition hit": ["failure"],
}
SUITE = re.compile(r"(?:template<int (\w+)(?:, int (\w+))?>\s*)?"
                   r"struct (\w+) : rl::test_suite<(.*?)>\s*\{", re.S)
STD = re.compile(r"\bstd::(?=(?:atomic\w*|memory_order\w*|mo_\w+|mutex|recursive_mutex|unique_lock|"
                 r"condition_variable(?:_any)?|lock_guard|scoped_lock|thread)\b)")


class Case:
    def __init__(self, file, suite, expected):
        self.file, self.suite = file, suite
        self.known = "right" if expected == "success" else expected
        parts = pathlib.PurePath(file).with_suffix("").parts
        self.name = "/".join(parts[:2] + (suite,))
        self.module = re.sub(r"\W", "_", file)
        self.weak = "spurious" in suite
        self.untranslated = [why for name, why in UNTRANSLATED.items()
                             if (self.name + "/").startswith(name + "/")]


def cases(folder, results):
    """The suites of all files, as far as they are not commented out, with what they expect."""
    paths = sorted([*folder.glob("example/**/*.?pp"), *folder.glob("test/**/*.?pp")])
    files = {str(p.relative_to(folder)): p.read_text(errors="replace") for p in paths}
    bare = {f: re.sub(r"/\*.*?\*/|//[^\n]*", "", t, flags=re.S) for f, t in files.items()}
    everything, seen = "\n".join(bare.values()), set()
    for file, text in bare.items():
        if "/trash/" in file or "/g++/" in file or file.endswith("main.cpp"):
            continue
        said = re.findall(r"FAILS? WITH \"?([A-Z ]+)|struct (\w+) : rl::test_suite", files[file])
        for first, second, name, types in SUITE.findall(text):
            expected = (re.findall(r"^[^,]+(?:<[^>]*>)?,\s*\w+,\s*(.*)$", types, re.S) or ["0"])[0]
            expected = expected.replace("(rl::test_result_e)", "")
            expected = re.sub(r"rl::test_result_(\w+)", lambda m: str(results.index(m[1])), expected)
            above = said[:[suite for _, suite in said].index(name)][-1:]  # a comment, or a suite
            for given in re.findall(rf"simulate<{name}<([^>]*)>", everything) if first else [""]:
                values = dict(zip((first, second), given.split(",")))
                number = eval(re.sub(r"[a-z_]\w*", lambda m: values[m[0]], expected), {})
                result = results[number].replace("_", " ").replace("unit", "uninit")
                if above and above[0][0]:
                    result = above[0][0].lower().strip()
                if (file, name, given) not in seen:  # of `#if` and `#else` the first
                    yield Case(file, f"{name}<{given}>" if given else name, result)
                seen.add((file, name, given))
        for function in re.findall(r"^void (\w+)\(\)\n", text, re.M):
            if f"rl::execute<{function}," in everything:
                yield Case(file, function + "()", "success")


def translated(folder, file, suites):
    """The file without its main() and its headers, with a main() for our `suites` of it."""
    text = (folder / file).read_text(errors="replace")
    text = re.split(r"^int main\(", text, flags=re.M)[0]
    text = re.sub(r"^\s*#\s*include (\".*|<(windows|intrin)\.h>)", "", text, flags=re.M)
    begun, ended = (len(re.findall(rf"^\s*#\s*{word}", text, re.M)) for word in ("if", "endif"))
    text += "#endif\n" * (begun - ended)
    text = STD.sub("rl::", text.replace("using namespace std;", "using namespace rl;"))
    for old, new in EDITS.get(file, []):
        text, count = re.subn(old, new, text)
        if not count:
            peers.stop(f"{file}: nothing to edit")
    calls = "".join(f"    case {i}: return {s}, 0;\n" if s.endswith("()") else
                    f"    case {i}: return rl::run<{s}>();\n" for i, s in enumerate(suites))
    return f'#include "relacy.hpp"\n#line 1 "{file}"\n{text}\nint main(int, char** argv) {{\n' \
           f"  switch (argv[1][0] - 'a') {{\n{calls}  }}\n}}\n"


def main():
    options = peers.arguments(__doc__, "a file, or one suite of it", 20)
    folder = options.folder.resolve()
    results = re.findall(r"^\s*test_result_(\w+),", (folder / "relacy" / "test_result.hpp").read_text(),
                         re.M)
    all_cases = [c for c in cases(folder, results) if options.only in c.name]
    includes = "\n".join(f"#include <{header}>" for header in INCLUDES.split())
    enum = ", ".join(f"test_result_{r}" for r in results)
    project = peers.Project("relacy", {
        "relacy.hpp": SHIM.replace("INCLUDES", includes).replace("RESULTS", enum)})
    for module in dict.fromkeys(c.module for c in all_cases if not c.untranslated):
        same = [c for c in all_cases if c.module == module and not c.untranslated]
        for number, case in enumerate(same):
            case.argument = chr(ord("a") + number)
        source = project.folder / f"{module}.cpp"
        source.write_text(translated(folder, same[0].file, [c.suite for c in same]))
        project.add(module, [source], "-O0 -g -w -fpermissive -mcx16")
    project.build()
    table, differs = peers.TABLE[:], False
    for case in all_cases:
        if case.untranslated:
            result = {"verdict": "not translated: " + case.untranslated[0]}
        else:
            result = project.check(case.module, case.name, options.seconds,
                                   *(["--weak"] if case.weak else []), "--", case.argument)
        state = peers.judged(result, case.known != "right", ACCUSED.get(case.known))
        if state == "DIFFERS" and case.name in REASONS:
            state = "differs: " + REASONS[case.name]
        differs |= state == "DIFFERS"
        peers.add_row(table, case.name, case.known, result, state)
    peers.finish(table, options.out, differs)


main()
