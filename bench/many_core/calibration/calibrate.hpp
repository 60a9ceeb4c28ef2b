/// `irt calibrate`: the profile of the machine it runs on.
#pragma once

#include <string>
#include <vector>

#include "bench/many_core/calibration/primitives.hpp"
#include "bench/many_core/profiles/profile.hpp"

namespace irt::many_core {

/// A hardware thread this process may use, and the groups it is in, all counted from 0.
struct Place {
  Cpu cpu = 0;
  unsigned core = 0, cache = 0, node = 0, socket = 0;
};

/// Asks hwloc. Throws std::runtime_error where it cannot read the machine.
std::vector<Place> survey_places();

/// Puts `places` in the order in which profiles number threads, and the counts into `profile`.
/// Returns false where the groups are not all alike; they are then left out.
bool settle_topology(std::vector<Place>& places, Profile& profile);

/// What was measured, and what could not be.
struct Calibration {
  Profile profile;
  std::vector<std::string> remarks;  ///< a line each
  std::vector<std::string> checks;   ///< figures that are no part of the profile, a line each
};

/// Measures for some seconds. `date` goes into the sources. Throws std::runtime_error where the
/// machine cannot be read or threads cannot be bound.
Calibration calibrate(const std::string& name, const std::string& date);

}  // namespace irt::many_core
