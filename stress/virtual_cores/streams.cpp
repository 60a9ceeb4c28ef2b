// Of the C++ library's streams: what compiled code writes to objects of the code's own.

#include <ios>
#include <locale>

#include "stress/virtual_cores/internal.hpp"

// NOLINTBEGIN(bugprone-macro-parentheses): a type, and a part of a name
// A member of `class` without arguments that sets up, or ends, the object it is called for.
#define IRT_MEMBER(name, type)                                        \
  extern "C" void real_##name(type* object) asm(#name);               \
  IRT_REDIRECTED void irt_vc_##name(type* object) {                   \
    irt::virtual_cores::announce_write(object, sizeof(type), IRT_PC); \
    real_##name(object);                                              \
  }
// NOLINTEND(bugprone-macro-parentheses)

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
IRT_MEMBER(_ZNSt8ios_baseC2Ev, std::ios_base)
IRT_MEMBER(_ZNSt8ios_baseD2Ev, std::ios_base)
IRT_MEMBER(_ZNSt8ios_base7_M_initEv, std::ios_base)
IRT_MEMBER(_ZNSt6localeC1Ev, std::locale)
IRT_MEMBER(_ZNSt6localeD1Ev, std::locale)
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
#undef IRT_MEMBER
