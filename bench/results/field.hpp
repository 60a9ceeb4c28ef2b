/// What is known of one field of a run.
#pragma once

#include <cstdint>
#include <string_view>

namespace irt::results {

/// A set of tools.
using Tools = std::uint8_t;
inline constexpr Tools by_render = 1;      ///< `irt compare`, `irt render`
inline constexpr Tools by_collide = 2;     ///< `irt collide`
inline constexpr Tools by_replay = 4;      ///< `irt simulate --renderer`
inline constexpr Tools by_contention = 8;  ///< `irt bench contention`
inline constexpr Tools by_simulate = 16;   ///< `irt simulate`
inline constexpr Tools by_micro = 32;      ///< Google Benchmark's results, as they are read
inline constexpr Tools by_all = 63;

enum class Role : std::uint8_t {
  choice,     ///< made before measuring; always tells runs apart
  condition,  ///< what the figures came about under, or how to read them
  figure,     ///< what came out; never tells runs apart
};

/// Where readers put a field that tells runs apart.
enum class Place : std::uint8_t {
  series,   ///< among the choices: in the name of a line, over an axis, in a column
  subject,  ///< who was measured
  topic,    ///< what was measured: never two in one plot
  origin,   ///< measured or simulated, and on which machine
};

/// Made by the functions below, which name only what is so.
struct Field {
  std::string_view key;
  Tools by = 0;  ///< who writes it
  Role role = Role::figure;

  std::string_view title{};  ///< in names and at axes
  std::string_view unit{};
  std::string_view heading{};  ///< of a column: of a figure without one there is none

  bool tells_apart = false;  ///< runs that differ in it answer different questions
  Place place = Place::series;
  bool seen = false;     ///< the picture shows it: who agrees in all such has the same, to the bit
  bool sweeps = false;   ///< a number that figures may be drawn over
  bool follows = false;  ///< from other choices, as a rule

  bool plotted = false;
  bool skip_zeros = false;         ///< no plot where all values are 0
  std::string_view samples{};      ///< the field with one value per repetition, in the same unit
  std::string_view low{}, high{};  ///< the fields with its interval
  std::string_view added{};        ///< a second field that is added in plots

  /// The field as `change` leaves it. (Before those that use it, or Clang 14 cannot evaluate them.)
  template <class Change>
  [[nodiscard]] constexpr Field with(Change change) const {
    Field changed = *this;
    change(changed);
    return changed;
  }
  [[nodiscard]] constexpr Field at(Place where) const {
    return with([=](Field& f) { f.place = where; });
  }
  [[nodiscard]] constexpr Field in_picture() const {
    return with([](Field& f) { f.seen = true; });
  }
  [[nodiscard]] constexpr Field over() const {
    return with([](Field& f) { f.sweeps = true; });
  }
  [[nodiscard]] constexpr Field following() const {
    return with([](Field& f) { f.follows = true; });
  }
  [[nodiscard]] constexpr Field apart(std::string_view name) const {
    return with([=](Field& f) { f.tells_apart = true, f.title = name; });
  }
  [[nodiscard]] constexpr Field column(std::string_view name) const {
    return with([=](Field& f) { f.heading = name; });
  }
  [[nodiscard]] constexpr Field plot(std::string_view name, std::string_view in = {}) const {
    return with([=](Field& f) { f.plotted = true, f.title = name, f.unit = in; });
  }
  [[nodiscard]] constexpr Field unless_zero() const {
    return with([](Field& f) { f.skip_zeros = true; });
  }
  [[nodiscard]] constexpr Field with_samples(std::string_view field) const {
    return with([=](Field& f) { f.samples = field; });
  }
  [[nodiscard]] constexpr Field within(std::string_view least, std::string_view most) const {
    return with([=](Field& f) { f.low = least, f.high = most; });
  }
  [[nodiscard]] constexpr Field plus(std::string_view field) const {
    return with([=](Field& f) { f.added = field; });
  }
};

constexpr Field choice(std::string_view key, Tools by, std::string_view title,
                       std::string_view unit = {}) {
  return {.key = key,
          .by = by,
          .role = Role::choice,
          .title = title,
          .unit = unit,
          .tells_apart = true};
}
constexpr Field condition(std::string_view key, Tools by) {
  return {.key = key, .by = by, .role = Role::condition};
}
constexpr Field figure(std::string_view key, Tools by) {
  return {.key = key, .by = by, .role = Role::figure};
}

}  // namespace irt::results
