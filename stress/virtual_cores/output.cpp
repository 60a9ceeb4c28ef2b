// What instrumented code writes to its outputs: the C library does it, and what it reads for that
// is announced.

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <printf.h>
#include <unistd.h>
#include <vector>

#include "stress/virtual_cores/internal.hpp"

namespace {

using irt::virtual_cores::announce_read;
using irt::virtual_cores::announce_write;

void read_text(const char* text, const void* pc) {
  if (text != nullptr) announce_read(text, std::strlen(text) + 1, pc);
}

/// The texts that `format` takes from `arguments`. Those whose length a precision bounds need not
/// end, and are left out.
void read_texts(const char* format, std::va_list arguments, const void* pc) {
  read_text(format, pc);
  std::vector<int> types(parse_printf_format(format, 0, nullptr));
  parse_printf_format(format, types.size(), types.data());
  const bool bounded = std::strstr(format, ".*") != nullptr;
  std::va_list rest;
  va_copy(rest, arguments);
  for (const int type : types) {
    switch (type & ~PA_FLAG_MASK) {
      case PA_FLOAT:
      case PA_DOUBLE:
        if ((type & PA_FLAG_LONG_DOUBLE) != 0) {
          [[maybe_unused]] const long double skipped = va_arg(rest, long double);
        } else {
          [[maybe_unused]] const double skipped = va_arg(rest, double);
        }
        break;
      case PA_STRING: {
        const char* text = va_arg(rest, const char*);
        if (!bounded) read_text(text, pc);
        break;
      }
      default:  // in one general register, whatever its size
        static_cast<void>(va_arg(rest, std::uint64_t));
    }
  }
  va_end(rest);
}

int write_to(std::FILE* file, const char* format, std::va_list arguments, const void* pc) {
  read_texts(format, arguments, pc);
  return std::vfprintf(file, format, arguments);
}

int write_into(char* to, std::size_t size, const char* format, std::va_list arguments,
               const void* pc) {
  read_texts(format, arguments, pc);
  const int length = std::vsnprintf(to, size, format, arguments);
  if (length >= 0 && size != 0)
    announce_write(to, std::min(static_cast<std::size_t>(length) + 1, size), pc);
  return length;
}

}  // namespace

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)

// A function with `...` in terms of the one with a va_list.
#define IRT_VARIADIC(call)     \
  std::va_list arguments;      \
  va_start(arguments, format); \
  const int result = call;     \
  va_end(arguments);           \
  return result

IRT_REDIRECTED int irt_vc_printf(const char* format, ...) {
  IRT_VARIADIC(write_to(stdout, format, arguments, IRT_PC));
}
IRT_REDIRECTED int irt_vc_fprintf(std::FILE* file, const char* format, ...) {
  IRT_VARIADIC(write_to(file, format, arguments, IRT_PC));
}
IRT_REDIRECTED int irt_vc_snprintf(char* to, std::size_t size, const char* format, ...) {
  IRT_VARIADIC(write_into(to, size, format, arguments, IRT_PC));
}
IRT_REDIRECTED int irt_vc_sprintf(char* to, const char* format, ...) {
  constexpr std::size_t no_limit = std::size_t{1} << 30U;
  IRT_VARIADIC(write_into(to, no_limit, format, arguments, IRT_PC));
}
#undef IRT_VARIADIC
IRT_REDIRECTED int irt_vc_vprintf(const char* format, std::va_list arguments) {
  return write_to(stdout, format, arguments, IRT_PC);
}
IRT_REDIRECTED int irt_vc_vfprintf(std::FILE* file, const char* format, std::va_list arguments) {
  return write_to(file, format, arguments, IRT_PC);
}
IRT_REDIRECTED int irt_vc_vsnprintf(char* to, std::size_t size, const char* format,
                                    std::va_list arguments) {
  return write_into(to, size, format, arguments, IRT_PC);
}
IRT_REDIRECTED int irt_vc_puts(const char* text) {
  read_text(text, IRT_PC);
  return std::puts(text);
}
IRT_REDIRECTED int irt_vc_fputs(const char* text, std::FILE* file) {
  read_text(text, IRT_PC);
  return std::fputs(text, file);
}
IRT_REDIRECTED std::size_t irt_vc_fwrite(const void* from, std::size_t size, std::size_t count,
                                         std::FILE* file) {
  announce_read(from, size * count, IRT_PC);
  return std::fwrite(from, size, count, file);
}
IRT_REDIRECTED void irt_vc_perror(const char* text) {
  read_text(text, IRT_PC);
  errno = irt::virtual_cores::core_errno();
  std::perror(text);
}
IRT_REDIRECTED ssize_t irt_vc_write(int file, const void* from, std::size_t size) {
  announce_read(from, size, IRT_PC);
  return write(file, from, size);
}

// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
