/// Virtual cores: ordinary C++ compiled with `-fsanitize=thread`, run on fibers, one event at a
/// time, under the eyes of a *tenant* who decides what each event does.
///
/// Who would explore or simulate concurrent code does three things:
///
///     class Mine : public Tenant { ... };  // what happens at each event
///     Module module("libmy_queue.so");     // made by irt_virtual_module()
///     Cores cores(tenant, 4);              // four virtual cores
///     cores.arm(0, entry, argument);
///     cores.run(0);
///
/// The code sees std::atomic, std::mutex, pthread, malloc and thread_local as always; nothing in
/// its source knows of virtual cores. `irt_virtual_module` (CMake) compiles it with the
/// thread sanitizer's instrumentation, which turns every access to shared memory into a call, and
/// links it with this runtime instead of the sanitizer's. Calls of the C library are redirected in
/// the object file (`redirected.syms`), so only the module is affected, never its host.
///
/// Everything runs on one operating-system thread: the state of the runtime is global, and a
/// process hosts one `Cores::run` at a time. Spread work over processes, not threads.
///
/// Not seen: inline assembly, SIMD intrinsics that store past the sanitizer, and compiled
/// libraries that the module calls (`Module::unseen_calls` names these). What the C++ library
/// compiles for containers, strings, memory resources and futures is seen: a module has its own
/// instrumented copy, by templates or from `library/`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "stress/virtual_cores/modification.hpp"

namespace irt::virtual_cores {

/// A word of up to 16 bytes. Narrower values are zero-extended.
__extension__ using Value = unsigned __int128;

/// std::memory_order, by the same numbers.
enum class Order : std::uint8_t { relaxed, consume, acquire, release, acq_rel, seq_cst };

constexpr bool acquires(Order order) {
  return order == Order::consume || order == Order::acquire || order >= Order::acq_rel;
}
constexpr bool releases(Order order) {
  return order >= Order::release;
}

/// `size` bytes of real memory as a value, and back.
Value read_memory(std::uintptr_t address, std::size_t size);
void write_memory(std::uintptr_t address, std::size_t size, Value value);

/// One access to an atomic object.
struct Access {
  std::uintptr_t address;
  std::uint32_t size;  ///< bytes: 1, 2, 4, 8 or 16
  Order order;
  const void* pc;  ///< where the code will go on: the line is that of `pc` - 1
};

/// A fiber may be asked to go on with this instead of another core: back to the caller of `run`.
inline constexpr unsigned host = ~0U;

/// The core in progress, or `host`. Only Cores changes it.
extern unsigned current_core;

/// What a futex wait ended with.
enum class Wake : std::uint8_t { woken, value_differs, timed_out };

/// What code that is a whole program asks for besides: threads of its own, and an end.
class Process {
 public:
  Process() = default;
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  virtual ~Process() = default;

  /// Has a core begin at `entry(argument)`; returns its number.
  virtual unsigned begin_thread(void (*entry)(void*), void* argument, const void* pc) = 0;
  /// Returns once `core` is at the end of its entry function.
  virtual void join(unsigned core, const void* pc) = 0;
  /// The process ends with `status`; the core in progress goes no further.
  virtual void exit(int status, const void* pc) = 0;
  /// The code takes no interest in what the core in progress would do from here on.
  [[noreturn]] virtual void dismiss(const void* pc) = 0;
};

/// Decides what happens at every event of the instrumented code. Each method runs on the fiber of
/// the core that caused the event and may switch to another core before it returns. The defaults
/// do what a single core with sequentially consistent memory would.
class Tenant {
 public:
  Tenant() = default;
  Tenant(const Tenant&) = delete;
  Tenant& operator=(const Tenant&) = delete;
  virtual ~Tenant() = default;

  // Memory.
  /// A plain access of `size` bytes is about to happen; the code itself performs it.
  virtual void plain_read(std::uintptr_t address, std::size_t size, const void* pc);
  virtual void plain_write(std::uintptr_t address, std::size_t size, const void* pc);
  virtual Value load(const Access& access);
  virtual void store(const Access& access, Value value);
  /// Returns the value read.
  virtual Value modify(const Access& access, Modification modification, Value operand);
  /// Returns whether `desired` was stored; `expected` becomes the value read. `access.order` is
  /// the order of success.
  virtual bool compare_exchange(const Access& access, Order failure, bool weak, Value& expected,
                                Value desired);
  virtual void fence(Order order, const void* pc);

  // The heap. `allocate` returns null when memory is exhausted; `release` is never given null.
  virtual void* allocate(std::size_t size, std::size_t alignment, const void* pc);
  virtual void release(void* block, const void* pc);
  /// Bytes of a block of `allocate`.
  virtual std::size_t block_size(void* block);

  // Waiting. Mutexes, condition variables, semaphores, rw locks and barriers of the code come down
  // to these. A lock is four bytes at `address`, zero when free.
  /// Waits for at most `nanoseconds` if that is not negative. Returns whether it has the lock.
  virtual bool lock(std::uintptr_t address, std::int64_t nanoseconds, const void* pc);
  virtual bool try_lock(std::uintptr_t address, const void* pc);
  virtual void unlock(std::uintptr_t address, const void* pc);
  /// Sleeps if four bytes at `address` hold `expected`, for at most `nanoseconds` if that is not
  /// negative.
  virtual Wake wait(std::uintptr_t address, std::uint32_t expected, std::int64_t nanoseconds,
                    const void* pc);
  /// Wakes up to `count` sleepers; returns how many.
  virtual unsigned wake(std::uintptr_t address, unsigned count, const void* pc);
  virtual void yield(const void* pc);
  virtual void sleep(std::int64_t nanoseconds, const void* pc);
  /// The instruction that spinning loops wait with.
  virtual void pause();
  /// Nanoseconds of virtual time.
  virtual std::int64_t now();
  /// The next random number of the core in progress, for std::random_device and the like. The
  /// default's are the same in every process.
  virtual std::uint64_t random();

  /// Of code that is a program of its own; null: a thread that it starts is refused.
  virtual Process* process();

  // Control flow.
  virtual void enter_function(const void* call_site);
  /// The core in progress returns to its caller: what is below `frame_end` on its stack is no more.
  virtual void leave_function(std::uintptr_t frame_end, const void* pc);
  /// A core came to the end of its entry function. Returns who goes on, or `host`.
  virtual unsigned finished(unsigned core);
  /// The code cannot go on: an uncaught exception, abort(), a failed assertion, an unsupported
  /// call. Must not return; the default prints `what` and exits the process.
  virtual void on_failure(const std::string& what, const void* pc);
  [[noreturn]] void failed(const std::string& what, const void* pc);
};

/// The code asks for what virtual cores do not have, which is no fault of its own: says so and ends
/// the process with code 2.
[[noreturn]] void refuse(const std::string& what);
/// The file that this is said on: that of the error output, unless it is the code's own.
extern int refusals_to;

/// The callee-saved registers at the last atomic operation, as the code had them: with the stack
/// above `stack_pointer` they are all that a loop can carry from one round to the next.
struct Registers {
  std::uint64_t rbx, rbp, r12, r13, r14, r15, stack_pointer;
};

/// The registers of the atomic operation in progress; `stack_pointer` is 0 for one that the runtime
/// makes on behalf of the code, as inside of pthread_rwlock_rdlock.
const Registers& registers();

/// Addresses from `begin` to before `end`.
struct Range {
  std::uintptr_t begin = 0;
  std::uintptr_t end = 0;
};

/// Whether `address` is in a variable of the C or C++ library, as std::cout is: to write to these
/// from several threads is no race, for the library sees to it.
bool is_of_library(std::uintptr_t address);

/// Where `core` keeps its thread_local variables; nothing once it has ended or begun anew.
std::vector<Range> thread_locals_of(unsigned core);

/// Makes global variables of a module: a function that is called with main's arguments.
using Constructor = void (*)(int, char**, char**);

/// Calls `main` on the core in progress as the C library does, with its names and arguments: what
/// it returns ends the process by `Process::exit`, and so does `exit()`, after what is registered
/// for that. `main` may be of any type that C and C++ allow.
/// Before it, `constructors` (`Module::constructors`) are called, if the module has not been told
/// to.
void run_program(void (*main)(), const std::vector<std::string>& arguments,
                 const std::vector<Constructor>& constructors = {});
/// Calls `body` on the core in progress as if it were all of a program, whose end is its own.
void run_body(const std::function<void()>& body);

/// The virtual cores. At most one object exists at a time.
class Cores {
 public:
  /// `stack_bytes` per core, at addresses that are the same in every run; memory is taken as it is
  /// used, but small stacks lie close together, which the host's caches like.
  Cores(Tenant& tenant, unsigned count, std::size_t stack_bytes = std::size_t{64} << 10U);
  Cores(const Cores&) = delete;
  Cores& operator=(const Cores&) = delete;
  ~Cores();

  /// Makes `core` begin at `entry(argument)` when it is next switched to. What it did before is
  /// abandoned: its stack is not unwound.
  void arm(unsigned core, void (*entry)(void*), void* argument);

  /// Runs from `first` until a core is switched to `host`.
  void run(unsigned first);

  /// From within a core: goes on with `core`, or with the caller of `run` if that is `host`.
  /// Returns when somebody switches back.
  void switch_to(unsigned core);

  /// `core` will soon be switched to: loads the top of its stack into the host's first cache.
  void prefetch(unsigned core) const;

  [[nodiscard]] unsigned count() const;
  /// The core in progress, or `host`.
  [[nodiscard]] unsigned current() const { return current_core; }
  /// The stack of `core`: lowest address and size in bytes.
  [[nodiscard]] std::uintptr_t stack_of(unsigned core) const;
  [[nodiscard]] std::size_t stack_bytes() const;
  /// What `core`, which waits to be switched to, has on its stack.
  [[nodiscard]] Range frames_of(unsigned core) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What becomes of code that only computes. The first two are asked at any moment.
class Computing {
 public:
  Computing() = default;
  Computing(const Computing&) = delete;
  Computing& operator=(const Computing&) = delete;
  virtual ~Computing() = default;

  /// A number that changes with whatever the core in progress does but compute.
  [[nodiscard]] virtual std::uint64_t beats() const = 0;
  /// Whether it may go on with that for more than `seconds` of the processor's time.
  [[nodiscard]] virtual bool patient(double seconds) const = 0;
  /// It may not, or it is certain that it never does anything else again (`endless`).
  [[noreturn]] virtual void spins(const void* pc, bool endless, double seconds) = 0;
};

/// Watches for code that runs on without an event, for which no tenant is ever asked, while this
/// lives. Uses SIGPROF, SIGTRAP and their timer.
class SpinWatch {
 public:
  SpinWatch(const Cores& cores, Computing& computing);
  SpinWatch(const SpinWatch&) = delete;
  SpinWatch& operator=(const SpinWatch&) = delete;
  ~SpinWatch();

  struct Search;

 private:
  std::unique_ptr<Search> search_;
};

/// Instrumented code in a shared object, with a symbol scope of its own.
class Module {
 public:
  /// Who calls the constructors of global variables: this class, once, after which they start no
  /// threads, or `run_program`. `with_main` is once, too, for code whose main is then called
  /// natively.
  enum class Constructs : std::uint8_t { once, each_program, with_main };

  /// Loads `file`. Throws std::runtime_error with the loader's words if that fails.
  explicit Module(const std::string& file, Constructs when = Constructs::once);
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;
  ~Module();

  /// The address of an exported function or object. Throws std::runtime_error if there is none.
  [[nodiscard]] void* find(const std::string& symbol) const;
  /// The same of several, the first that there is.
  [[nodiscard]] void* find_any(const std::vector<std::string>& symbols) const;
  template <class F>
  [[nodiscard]] F* function(const std::string& symbol) const {
    return reinterpret_cast<F*>(find(symbol));
  }

  /// Puts global variables, and what their constructors allocated, back to what they were after
  /// loading. Nobody may have returned such a block to the host's heap.
  void reset_globals();
  /// Of a module that is loaded `with_main`: from now on that goes back to what they hold now, as
  /// do all blocks that its code has allocated since it was loaded, and `others`.
  void remember_memory(const std::vector<Range>& others = {});
  /// That memory, in the order of addresses.
  [[nodiscard]] const std::vector<Range>& globals() const;
  [[nodiscard]] bool owns_global(std::uintptr_t address) const;
  /// What they hold, and the way back to that.
  [[nodiscard]] std::vector<char> image() const;
  void restore(const std::vector<char>& image);

  /// Functions outside the module that it calls, that may touch shared memory and that nobody
  /// observes, demangled; also tables of virtual functions and objects outside.
  [[nodiscard]] std::vector<std::string> unseen_calls() const;

  /// Of its global variables, in order; none if they were called.
  [[nodiscard]] const std::vector<Constructor>& constructors() const;

  [[nodiscard]] const std::string& file() const;
  /// What to subtract from an address to find it in the file.
  [[nodiscard]] std::uintptr_t load_offset() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace irt::virtual_cores
