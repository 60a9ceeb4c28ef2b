// Accesses in every form in which a compiler can make them, each against a plain one: a data race.
// Those of forms_unseen.cpp are not announced, and must be named.

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <optional>
#include <vector>

#include "tests/stress/checker/findings.hpp"

namespace {

using irt::findings::Program;

struct Small {
  long a;
};
struct Pair {
  long a, b;
};
struct Reals {
  double a, b;
};
struct Odd {
  char a[3];
};
struct Large {
  long a[6];
};
struct Bits {
  unsigned a : 5, b : 7;
};

template <class T>
T object;
char bytes[64];
char other[64];
std::atomic<long> atomic;
volatile long sink;

template <class T>
[[gnu::noinline, gnu::noipa]] T make() {
  return T{};
}
template <class T>
[[gnu::noinline, gnu::noipa]] long use(T value) {
  return reinterpret_cast<const char&>(value);
}
template <class T>
[[gnu::noinline, gnu::noipa]] T make_or_throw(bool fail) {
  if (fail) throw 1;
  return T{};
}

template <class T>
void touch() {
  auto* first = reinterpret_cast<volatile char*>(&object<T>);
  *first = static_cast<char>(*first + 1);
}
template <class T>
void result() {
  object<T> = make<T>();
}
template <class T>
void argument() {
  sink = use(object<T>);
}
template <class T>
void result_or_throw() {
  try {
    object<T> = make_or_throw<T>(false);
  } catch (int) {
    sink = 1;
  }
}
template <class T>
void write() {
  object<T> = T{};
}
template <class T>
void read() {
  const T copy = object<T>;
  sink = reinterpret_cast<const char&>(copy);
}

// `data` is bytes 16 to 31 at least.
void touch_byte() {
  bytes[20] = 1;
}
char* data() {
  return bytes + 16;
}

template <class T>
constexpr Program race(const char* name, void (*form)()) {
  return {name, "data race", {form, touch<T>}};
}
constexpr Program on_bytes(const char* name, void (*form)()) {
  return {name, "data race", {form, touch_byte}};
}

const Program programs[] = {
    race<Small>("the result, 8 bytes", result<Small>),
    race<Pair>("the result, 16 bytes", result<Pair>),
    race<Reals>("the result, in vector registers", result<Reals>),
    race<Odd>("the result, 3 bytes", result<Odd>),
    race<Large>("the result, in memory", result<Large>),
    race<std::optional<long>>("the result, optional", result<std::optional<long>>),
    race<_Complex double>("the result, complex", result<_Complex double>),
    race<long double>("the result, long double", result<long double>),
    race<Pair>("the result of what may throw", result_or_throw<Pair>),
    race<Large>("a large result of what may throw", result_or_throw<Large>),
    race<Small>("the argument, 8 bytes", argument<Small>),
    race<Pair>("the argument, 16 bytes", argument<Pair>),
    race<Odd>("the argument, 3 bytes", argument<Odd>),
    race<Large>("the argument, in memory", argument<Large>),
    race<Large>("zeroes", write<Large>),
    race<Large>("a copy", read<Large>),
    race<Bits>("a bit-field", [] { object<Bits>.b = 3; }),
    race<std::vector<bool>*>("vector<bool>",
                             [] {
                               std::vector<bool> own(64);
                               sink = own[7] ? 1 : 0;
                               object<std::vector<bool>*> = nullptr;
                             }),
    on_bytes("memcpy to", [] { __builtin_memcpy(data(), other, 8); }),
    on_bytes("memcpy from", [] { __builtin_memcpy(other, data(), 16); }),
    on_bytes("memcpy, large", [] { __builtin_memcpy(data(), other, 40); }),
    on_bytes("memmove", [] { __builtin_memmove(data(), data() + 2, 24); }),
    on_bytes("memset", [] { __builtin_memset(data(), 0, 24); }),
    on_bytes("memcmp", [] { sink = __builtin_memcmp(data(), other, 16); }),
    on_bytes("memcmp for equality", [] { sink = __builtin_memcmp(data(), other, 16) == 0; }),
    on_bytes("strlen", [] { sink = static_cast<long>(__builtin_strlen(bytes + 20)); }),
    on_bytes("strcmp", [] { sink = __builtin_strcmp(bytes + 20, "ab"); }),
    on_bytes("strcpy", [] { __builtin_strcpy(data(), "abcdef"); }),
    on_bytes("std::fill", [] { std::fill_n(data(), 24, 'a'); }),
    on_bytes("std::copy", [] { std::copy(other, other + 24, data()); }),
    on_bytes("std::equal", [] { sink = std::equal(other, other + 24, data()) ? 1 : 0; }),
    race<long>("what a compare-exchange expects, read",
               [] { atomic.compare_exchange_strong(object<long>, 1); }),
    race<long>("what a compare-exchange finds, written",
               [] {
                 atomic.store(5);
                 atomic.compare_exchange_strong(object<long>, 1);
               }),
};

}  // namespace

// What no hook announces.
extern "C" long irt_forms_unseen(long* place) {
  long read = 0;
  asm volatile("mov %1, %0" : "=r"(read) : "m"(*place));
  asm volatile("movq $1, %0" : "=m"(*place));
  asm volatile("addq $1, (%0)" : : "r"(place) : "memory");
  return read;
}
extern "C" [[gnu::no_sanitize_thread]] void irt_forms_left_out(long* place) {
  *place = 1;
}

extern "C" const Program* irt_forms_programs(unsigned* count) {
  *count = sizeof programs / sizeof *programs;
  return programs;
}
