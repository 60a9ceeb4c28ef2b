/// Short ways to write histories by hand.
#pragma once

#include <initializer_list>
#include <vector>

#include "stress/history/operation.hpp"

namespace irt::stress {

inline Operation push(Element value, Stamp from, Stamp to) {
  return {from, to, value, Kind::push};
}
inline Operation pop(Element value, Stamp from, Stamp to) {
  return {from, to, value, Kind::pop};
}
inline Operation empty(Stamp from, Stamp to) {
  return {from, to, 0, Kind::empty};
}
inline Operation full(Element value, Stamp from, Stamp to) {
  return {from, to, value, Kind::full};
}
inline Operation meet(Stamp at) {
  return {at, at, 0, Kind::meet};
}

inline History history(std::initializer_list<std::vector<Operation>> logs,
                       std::vector<Operation> drain = {}) {
  return {.logs = logs, .drain = std::move(drain), .error = 0};
}

}  // namespace irt::stress
