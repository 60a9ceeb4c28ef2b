// What is compiled into libstdc++ and reads or writes memory of the code: announced, and then done
// by libstdc++ itself. (What it does to nodes is in library/.)

#include <cstddef>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include "stress/virtual_cores/internal.hpp"

using irt::virtual_cores::announce_read;
using irt::virtual_cores::announce_write;

// NOLINTBEGIN(bugprone-reserved-identifier,bugprone-sizeof-container,readability-identifier-naming)

// --- Hash tables: when they grow, and to what size --------------------------------------------

namespace {

using Policy = std::__detail::_Prime_rehash_policy;

/// Calls `work` with a copy of `policy`, which may change when it will grow next.
template <class Work>
auto with_policy(const Policy* policy, const void* pc, Work work) {
  announce_read(policy, sizeof *policy, pc);
  const Policy copy = *policy;
  const auto result = work(copy);
  if (copy._M_next_resize != policy->_M_next_resize) {
    announce_write(&policy->_M_next_resize, sizeof policy->_M_next_resize, pc);
    policy->_M_next_resize = copy._M_next_resize;
  }
  return result;
}

}  // namespace

IRT_REDIRECTED std::size_t irt_vc__ZNKSt8__detail20_Prime_rehash_policy11_M_next_bktEm(
    const Policy* policy, std::size_t buckets) {
  return with_policy(policy, IRT_PC, [&](const Policy& p) { return p._M_next_bkt(buckets); });
}

/// std::pair<bool, std::size_t>, which is returned in registers, in C's terms.
struct IrtRehash {
  bool needed;
  std::size_t buckets;
};
IRT_REDIRECTED IrtRehash irt_vc__ZNKSt8__detail20_Prime_rehash_policy14_M_need_rehashEmmm(
    const Policy* policy, std::size_t buckets, std::size_t elements, std::size_t more) {
  const auto [needed, size] = with_policy(
      policy, IRT_PC, [&](const Policy& p) { return p._M_need_rehash(buckets, elements, more); });
  return {needed, size};
}

IRT_REDIRECTED std::size_t irt_vc__ZSt11_Hash_bytesPKvmm(const void* bytes, std::size_t size,
                                                         std::size_t seed) {
  if (size != 0) announce_read(bytes, size, IRT_PC);
  return std::_Hash_bytes(bytes, size, seed);
}
IRT_REDIRECTED std::size_t irt_vc__ZSt15_Fnv_hash_bytesPKvmm(const void* bytes, std::size_t size,
                                                             std::size_t seed) {
  if (size != 0) announce_read(bytes, size, IRT_PC);
  return std::_Fnv_hash_bytes(bytes, size, seed);
}

// --- Exceptions: the text they are made with ---------------------------------------------------

#define IRT_TEXT_(mangled, type, variant)                                                      \
  IRT_REDIRECTED void irt_vc__ZN##mangled##variant##EPKc(std::type* error, const char* text) { \
    for (const char* at = text;; ++at) {                                                       \
      announce_read(at, 1, IRT_PC);                                                            \
      if (*at == '\0') break;                                                                  \
    }                                                                                          \
    new (error) std::type(text);                                                               \
  }                                                                                            \
  IRT_REDIRECTED void                                                                          \
      irt_vc__ZN##mangled##variant##ERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE(   \
          std::type* error, const std::string& text) {                                         \
    announce_read(&text, sizeof text, IRT_PC);                                                 \
    announce_read(text.data(), text.size() + 1, IRT_PC);                                       \
    new (error) std::type(text);                                                               \
  }
// As a whole object, and as the base of another one.
#define IRT_TEXT(mangled, type) \
  IRT_TEXT_(mangled, type, C1)  \
  IRT_TEXT_(mangled, type, C2)
IRT_TEXT(St11logic_error, logic_error)
IRT_TEXT(St12domain_error, domain_error)
IRT_TEXT(St16invalid_argument, invalid_argument)
IRT_TEXT(St12length_error, length_error)
IRT_TEXT(St12out_of_range, out_of_range)
IRT_TEXT(St13runtime_error, runtime_error)
IRT_TEXT(St11range_error, range_error)
IRT_TEXT(St14overflow_error, overflow_error)
IRT_TEXT(St15underflow_error, underflow_error)

// NOLINTEND(bugprone-reserved-identifier,bugprone-sizeof-container,readability-identifier-naming)
