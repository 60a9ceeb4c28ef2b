// Threads that instrumented code starts itself, POSIX's and C11's, and how a program ends, in terms
// of the tenant's `Process`. Where it has none both are refused.

#include <cerrno>
#include <pthread.h>
#include <system_error>
#include <thread>
#include <threads.h>
#include <unistd.h>
#include <utility>

#include "stress/virtual_cores/internal.hpp"

namespace {

using irt::virtual_cores::active;
using irt::virtual_cores::address_of;
using irt::virtual_cores::announce_write;
using irt::virtual_cores::current_core;
using irt::virtual_cores::end_core;
using irt::virtual_cores::host;
using irt::virtual_cores::Process;
using irt::virtual_cores::refuse;
using irt::virtual_cores::run_thread_exits;

struct Thread {
  void* (*routine)(void*) = nullptr;    ///< POSIX's kind, or ...
  int (*c11_routine)(void*) = nullptr;  ///< ... C11's
  void* argument = nullptr;
  void* result = nullptr;
  bool exits = false;             ///< pthread_exit was called, ...
  const void* exit_pc = nullptr;  ///< ... there
  bool joinable = false;          ///< neither joined nor detached
};

// By core; the cores that a program has not begun are not joinable.
std::vector<Thread> threads;

Thread& thread_of(unsigned core) {
  if (core >= threads.size()) threads.resize(core + 1);
  return threads[core];
}

// What a C11 thread ends with, where POSIX's ends with a pointer.
void* pointer_to(int result) {
  return reinterpret_cast<void*>(std::intptr_t{result});  // NOLINT(performance-no-int-to-ptr)
}

// Unwinds a thread that ends in the midst of its functions.
struct ThreadExit {};

/// `work()` as all that the core in progress does, up to the destructors of its thread_locals.
template <class Work>
void run_thread(Work work) {
  const unsigned core = current_core;
  try {
    work();
    if (thread_of(core).exits)
      active->failed("pthread_exit() was caught by `catch (...)` and not thrown again", nullptr);
  } catch (const ThreadExit&) {
    // Functions in C are left without a word.
    active->leave_function(address_of(__builtin_frame_address(0)), thread_of(core).exit_pc);
  }
  run_thread_exits(core);
}

void begin(void*) {
  run_thread([] {
    const Thread begun = thread_of(current_core);
    void* const result = begun.routine != nullptr ? begun.routine(begun.argument)
                                                  : pointer_to(begun.c11_routine(begun.argument));
    thread_of(current_core).result = result;
  });
}

Process& process() {
  if (Process* const process = active->process()) return *process;
  refuse("starts a thread of its own");
}

int create(pthread_t* thread, const Thread& begun, const void* pc) {
  announce_write(thread, sizeof *thread, pc);
  const unsigned core = process().begin_thread(begin, nullptr, pc);
  thread_of(core) = begun;
  *thread = core + pthread_t{1};
  return 0;
}

int join(pthread_t thread, void** result, const void* pc) {
  const auto core = static_cast<unsigned>(thread - 1);
  if (core >= threads.size()) return ESRCH;
  if (core == current_core) return EDEADLK;
  if (!std::exchange(threads[core].joinable, false)) return EINVAL;
  process().join(core, pc);
  if (result == nullptr) return 0;
  announce_write(result, sizeof *result, pc);
  *result = threads[core].result;
  return 0;
}

int detach(pthread_t thread) {
  const auto core = static_cast<unsigned>(thread - 1);
  if (core >= threads.size()) return ESRCH;
  return std::exchange(threads[core].joinable, false) ? 0 : EINVAL;
}

[[noreturn]] void end_thread(void* result, const void* pc) {
  process();  // there is one
  Thread& me = thread_of(current_core);
  me.result = result;
  me.exits = true;
  me.exit_pc = pc;
  throw ThreadExit();
}

int in_c11(int error) {
  return error == 0 ? thrd_success : thrd_error;
}

}  // namespace

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming,performance-no-int-to-ptr)

IRT_REDIRECTED int irt_vc_pthread_create(pthread_t* thread, const pthread_attr_t* attributes,
                                         void* (*routine)(void*), void* argument) {
  int state = PTHREAD_CREATE_JOINABLE;
  if (attributes != nullptr) pthread_attr_getdetachstate(attributes, &state);
  const bool joinable = state == PTHREAD_CREATE_JOINABLE;
  return create(thread, {.routine = routine, .argument = argument, .joinable = joinable}, IRT_PC);
}
IRT_REDIRECTED int irt_vc_pthread_join(pthread_t thread, void** result) {
  return join(thread, result, IRT_PC);
}
IRT_REDIRECTED int irt_vc_pthread_detach(pthread_t thread) {
  return detach(thread);
}
IRT_REDIRECTED void irt_vc_pthread_exit(void* result) {
  end_thread(result, IRT_PC);
}
IRT_REDIRECTED pthread_t irt_vc_pthread_self() {
  return current_core + pthread_t{1};
}
asm(".globl irt_vc_thrd_current\n.set irt_vc_thrd_current, irt_vc_pthread_self");

IRT_REDIRECTED int irt_vc_thrd_create(thrd_t* thread, int (*routine)(void*), void* argument) {
  return in_c11(
      create(thread, {.c11_routine = routine, .argument = argument, .joinable = true}, IRT_PC));
}
IRT_REDIRECTED int irt_vc_thrd_join(thrd_t thread, int* result) {
  void* returned = nullptr;
  const int error = join(thread, &returned, IRT_PC);
  if (error != 0 || result == nullptr) return in_c11(error);
  announce_write(result, sizeof *result, IRT_PC);
  *result = static_cast<int>(reinterpret_cast<std::intptr_t>(returned));
  return thrd_success;
}
IRT_REDIRECTED int irt_vc_thrd_detach(thrd_t thread) {
  return in_c11(detach(thread));
}
IRT_REDIRECTED void irt_vc_thrd_exit(int result) {
  end_thread(pointer_to(result), IRT_PC);
}

// What programs that are written for verifiers call: only executions in which it holds matter.
IRT_REDIRECTED void irt_vc___VERIFIER_assume(bool holds) {
  if (!holds) process().dismiss(IRT_PC);
}

// std::thread's members, by their mangled names. The state is passed by reference, as classes are
// that have a destructor.
namespace {

struct StdThread {
  pthread_t id;
};

void* run_state(void* state) {
  const std::thread::_State_ptr owned(static_cast<std::thread::_State*>(state));
  owned->_M_run();
  return nullptr;
}

void succeed(int error, const char* what) {
  if (error != 0) throw std::system_error(error, std::generic_category(), what);
}

}  // namespace
IRT_REDIRECTED void
irt_vc__ZNSt6thread15_M_start_threadESt10unique_ptrINS_6_StateESt14default_deleteIS1_EEPFvvE(
    StdThread* thread, std::thread::_State_ptr* state, void (*)()) {
  create(&thread->id, {.routine = run_state, .argument = state->get(), .joinable = true}, IRT_PC);
  static_cast<void>(state->release());  // the thread owns it
}
IRT_REDIRECTED void irt_vc__ZNSt6thread4joinEv(StdThread* thread) {
  succeed(thread->id == 0 ? EINVAL : join(thread->id, nullptr, IRT_PC), "std::thread::join");
  thread->id = 0;
}
IRT_REDIRECTED void irt_vc__ZNSt6thread6detachEv(StdThread* thread) {
  succeed(thread->id == 0 ? EINVAL : detach(thread->id), "std::thread::detach");
  thread->id = 0;
}

// A program is as if on a machine of two processors, on whatever machine it is looked at.
IRT_REDIRECTED unsigned irt_vc__ZNSt6thread20hardware_concurrencyEv() {
  return active->process() != nullptr ? 2 : std::thread::hardware_concurrency();
}

// --- The end ---------------------------------------------------------------------------------

namespace {

struct Handler {
  void (*function)(void*);
  void* argument;
};

// What constructors of global variables and `main` have registered.
std::vector<Handler> at_exit;

// What is registered natively is for the end of the host, which the code's variables do not
// outlive.
int register_handler(Handler handler) {
  if (current_core != host) at_exit.push_back(handler);
  return 0;
}

void end_process(int status, const void* pc) {
  Process* const process = active->process();
  if (process == nullptr) active->failed("exit() was called", pc);
  run_thread_exits(current_core);
  while (!at_exit.empty()) {
    const Handler last = at_exit.back();
    at_exit.pop_back();
    last.function(last.argument);
  }
  process->exit(status, pc);
  end_core();
}

void end_at_once(int status, const void* pc) {
  Process* const process = active->process();
  if (process == nullptr) active->failed("exit() was called", pc);
  process->exit(status, pc);
  end_core();
}

}  // namespace

IRT_REDIRECTED void irt_vc_exit(int status) {
  end_process(status, IRT_PC);
}
IRT_REDIRECTED void irt_vc__exit(int status) {
  end_at_once(status, IRT_PC);
}
asm(".globl irt_vc__Exit\n.set irt_vc__Exit, irt_vc__exit");
asm(".globl irt_vc_quick_exit\n.set irt_vc_quick_exit, irt_vc__exit");
IRT_REDIRECTED int irt_vc_atexit(void (*function)()) {
  return register_handler(
      {[](void* f) { reinterpret_cast<void (*)()>(f)(); }, reinterpret_cast<void*>(function)});
}
IRT_REDIRECTED int irt_vc_at_quick_exit(void (*)()) {
  return 0;
}
IRT_REDIRECTED int irt_vc___cxa_atexit(void (*function)(void*), void* argument, void*) {
  return register_handler({function, argument});
}

namespace irt::virtual_cores {

void run_program(void (*main)(), const std::vector<std::string>& arguments,
                 const std::vector<Constructor>& constructors) {
  threads.clear();
  at_exit.clear();
  run_thread([&] {
    // The code may write to them: each execution has its own.
    std::vector<std::string> words = arguments;
    std::vector<char*> names;
    names.reserve(words.size() + 1);
    for (std::string& word : words) names.push_back(word.data());
    names.push_back(nullptr);
    const auto count = static_cast<int>(words.size());
    for (const Constructor construct : constructors) construct(count, names.data(), environ);
    const auto call = reinterpret_cast<int (*)(int, char**, char**)>(main);
    end_process(call(count, names.data(), environ), nullptr);
  });
}

void run_body(const std::function<void()>& body) {
  threads.clear();
  at_exit.clear();
  run_thread([&] {
    body();
    run_thread_exits(current_core);
    end_at_once(0, nullptr);
  });
}

}  // namespace irt::virtual_cores
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming,performance-no-int-to-ptr)
