/// Primitives that cores compete for, as instrumented code: what closed forms and calibration know.
#pragma once

#include <span>

namespace irt::many_core {

struct Contended {
  const char* name;
  const char* summary;
  void* (*make)(unsigned threads);
  void (*step)(void* object, unsigned thread);
};

}  // namespace irt::many_core

/// All of them, from the module.
extern "C" std::span<const irt::many_core::Contended> irt_contended();
