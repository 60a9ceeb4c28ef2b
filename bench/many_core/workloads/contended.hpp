/// Primitives that cores compete for, as instrumented code: what closed forms and calibration know.
#pragma once

#include <span>

namespace irt::many_core {

struct Contended {
  const char* name;
  const char* summary;
  void* (*make)(unsigned threads);
  void (*step)(void* object, unsigned thread);
  bool waits = false;  ///< a step may wait for another thread's, for ever if that is the last one
};

/// All of them, by the module's `irt_contended`.
inline std::span<const Contended> all_contended(
    void (*irt_contended)(std::span<const Contended>&)) {
  std::span<const Contended> all;
  irt_contended(all);
  return all;
}

}  // namespace irt::many_core

/// Sets `all` to all of them, in the module.
extern "C" void irt_contended(std::span<const irt::many_core::Contended>& all);
