// The C library's functions on bytes and strings, as instrumented code sees them: what they read
// and write is announced, byte by byte where only the bytes say how far they go.

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "stress/virtual_cores/internal.hpp"

using irt::virtual_cores::active;
using irt::virtual_cores::announce_read;
using irt::virtual_cores::announce_write;

namespace {

constexpr std::size_t no_limit = std::numeric_limits<std::size_t>::max();

/// The byte at `place`.
unsigned char look(const void* place, const void* pc) {
  announce_read(place, 1, pc);
  return *static_cast<const unsigned char*>(place);
}

/// The distance to the first byte of `text` that is `wanted`, or zero if `to_end`; at most `limit`.
std::size_t find(const void* text, int wanted, bool to_end, std::size_t limit, const void* pc) {
  const auto* bytes = static_cast<const unsigned char*>(text);
  for (std::size_t i = 0; i < limit; ++i) {
    const unsigned char byte = look(bytes + i, pc);
    if (byte == static_cast<unsigned char>(wanted) || (to_end && byte == 0)) return i;
  }
  return limit;
}

std::size_t length(const char* text, const void* pc) {
  return find(text, 0, false, no_limit, pc);
}

/// Copies `size` bytes that were read already.
char* put(char* to, const char* from, std::size_t size, const void* pc) {
  if (size == 0) return to;
  announce_write(to, size, pc);
  return static_cast<char*>(std::memcpy(to, from, size));
}

void fill(void* to, int byte, std::size_t size, const void* pc) {
  if (size == 0) return;
  announce_write(to, size, pc);
  std::memset(to, byte, size);
}

int compare(const char* a, const char* b, std::size_t limit, bool to_end, const void* pc) {
  for (std::size_t i = 0; i < limit; ++i) {
    const int of_a = look(a + i, pc);
    const int of_b = look(b + i, pc);
    if (of_a != of_b) return of_a - of_b;
    if (to_end && of_a == 0) return 0;
  }
  return 0;
}

char* duplicate(const char* text, std::size_t size, const void* pc) {
  auto* block = static_cast<char*>(active->allocate(size + 1, 16, pc));
  if (block == nullptr) return nullptr;
  put(block, text, size, pc);
  fill(block + size, 0, 1, pc);
  return block;
}

}  // namespace

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)

IRT_REDIRECTED void* irt_vc_memcpy(void* to, const void* from, std::size_t size) {
  if (size == 0) return to;
  announce_read(from, size, IRT_PC);
  announce_write(to, size, IRT_PC);
  return std::memcpy(to, from, size);
}
IRT_REDIRECTED void* irt_vc_memmove(void* to, const void* from, std::size_t size) {
  if (size == 0) return to;
  announce_read(from, size, IRT_PC);
  announce_write(to, size, IRT_PC);
  return std::memmove(to, from, size);
}
IRT_REDIRECTED void* irt_vc_mempcpy(void* to, const void* from, std::size_t size) {
  if (size == 0) return to;
  announce_read(from, size, IRT_PC);
  announce_write(to, size, IRT_PC);
  return static_cast<char*>(std::memcpy(to, from, size)) + size;
}
IRT_REDIRECTED void* irt_vc_memset(void* to, int byte, std::size_t size) {
  fill(to, byte, size, IRT_PC);
  return to;
}
IRT_REDIRECTED void irt_vc_bzero(void* to, std::size_t size) {
  fill(to, 0, size, IRT_PC);
}
// The C library may read all of both, and its vector code does.
IRT_REDIRECTED int irt_vc_memcmp(const void* a, const void* b, std::size_t size) {
  if (size == 0) return 0;
  announce_read(a, size, IRT_PC);
  announce_read(b, size, IRT_PC);
  return std::memcmp(a, b, size);
}
IRT_REDIRECTED int irt_vc_bcmp(const void* a, const void* b, std::size_t size) {
  if (size == 0) return 0;
  announce_read(a, size, IRT_PC);
  announce_read(b, size, IRT_PC);
  return std::memcmp(a, b, size);
}
IRT_REDIRECTED void* irt_vc_memchr(const void* text, int byte, std::size_t size) {
  const std::size_t at = find(text, byte, false, size, IRT_PC);
  return at == size ? nullptr : const_cast<char*>(static_cast<const char*>(text)) + at;
}
IRT_REDIRECTED void* irt_vc_rawmemchr(const void* text, int byte) {
  return const_cast<char*>(static_cast<const char*>(text)) +
         find(text, byte, false, no_limit, IRT_PC);
}

IRT_REDIRECTED std::size_t irt_vc_strlen(const char* text) {
  return length(text, IRT_PC);
}
IRT_REDIRECTED std::size_t irt_vc_strnlen(const char* text, std::size_t limit) {
  return find(text, 0, false, limit, IRT_PC);
}
IRT_REDIRECTED char* irt_vc_strchr(const char* text, int byte) {
  const std::size_t at = find(text, byte, true, no_limit, IRT_PC);
  return text[at] == static_cast<char>(byte) ? const_cast<char*>(text) + at : nullptr;
}
IRT_REDIRECTED char* irt_vc_strrchr(const char* text, int byte) {
  length(text, IRT_PC);
  return const_cast<char*>(std::strrchr(text, byte));
}
IRT_REDIRECTED char* irt_vc_strstr(const char* text, const char* part) {
  length(text, IRT_PC);
  length(part, IRT_PC);
  return const_cast<char*>(std::strstr(text, part));
}
IRT_REDIRECTED int irt_vc_strcmp(const char* a, const char* b) {
  return compare(a, b, no_limit, true, IRT_PC);
}
IRT_REDIRECTED int irt_vc_strncmp(const char* a, const char* b, std::size_t limit) {
  return compare(a, b, limit, true, IRT_PC);
}
IRT_REDIRECTED char* irt_vc_strcpy(char* to, const char* from) {
  return put(to, from, length(from, IRT_PC) + 1, IRT_PC);
}
IRT_REDIRECTED char* irt_vc_stpcpy(char* to, const char* from) {
  const std::size_t size = length(from, IRT_PC);
  return put(to, from, size + 1, IRT_PC) + size;
}
IRT_REDIRECTED char* irt_vc_strncpy(char* to, const char* from, std::size_t size) {
  const std::size_t text = find(from, 0, false, size, IRT_PC);
  put(to, from, text, IRT_PC);
  fill(to + text, 0, size - text, IRT_PC);
  return to;
}
IRT_REDIRECTED char* irt_vc_strcat(char* to, const char* from) {
  put(to + length(to, IRT_PC), from, length(from, IRT_PC) + 1, IRT_PC);
  return to;
}
IRT_REDIRECTED char* irt_vc_strncat(char* to, const char* from, std::size_t limit) {
  char* const end = to + length(to, IRT_PC);
  const std::size_t size = find(from, 0, false, limit, IRT_PC);
  put(end, from, size, IRT_PC);
  fill(end + size, 0, 1, IRT_PC);
  return to;
}
// Numbers in texts. What is read is taken to be the whole text.
#define IRT_NUMBER(type, name, ...)                                                        \
  IRT_REDIRECTED type irt_vc_##name(const char* text, char** end __VA_OPT__(, int base)) { \
    announce_read(text, std::strlen(text) + 1, IRT_PC);                                    \
    if (end != nullptr) announce_write(end, sizeof *end, IRT_PC);                          \
    errno = 0;                                                                             \
    const type number = name(text, end __VA_OPT__(, base));                                \
    if (errno != 0) irt::virtual_cores::core_errno() = errno;                              \
    return number;                                                                         \
  }
IRT_NUMBER(long, strtol, base)
IRT_NUMBER(long long, strtoll, base)
IRT_NUMBER(unsigned long, strtoul, base)
IRT_NUMBER(unsigned long long, strtoull, base)
IRT_NUMBER(double, strtod)
IRT_NUMBER(float, strtof)
#undef IRT_NUMBER
IRT_REDIRECTED int irt_vc_atoi(const char* text) {
  announce_read(text, std::strlen(text) + 1, IRT_PC);
  return static_cast<int>(std::strtol(text, nullptr, 10));
}

IRT_REDIRECTED char* irt_vc_strdup(const char* text) {
  return duplicate(text, length(text, IRT_PC), IRT_PC);
}
IRT_REDIRECTED char* irt_vc_strndup(const char* text, std::size_t limit) {
  return duplicate(text, find(text, 0, false, limit, IRT_PC), IRT_PC);
}

// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
