/// Names for what registers and stack slots hold, in code that is read and not run.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace irt::symbols {

/// A value by name: a root, which is something unknown, and a distance from it.
struct NamedValue {
  std::uint32_t root = 0;  ///< 0: a number, or an address in the file
  std::int64_t offset = 0;
  // NOLINTNEXTLINE(modernize-use-nullptr): of the comparison that the compiler writes
  friend auto operator<=>(const NamedValue&, const NamedValue&) = default;
};

inline constexpr std::uint32_t stack_root = 1;
inline constexpr std::uint32_t argument_root = 2;  ///< what rdi was at the beginning

/// Names for unknown values: the same for the same operation on the same values.
class ValueNames {
 public:
  using Key = std::tuple<std::string, NamedValue, NamedValue, std::int64_t>;

  NamedValue of(const std::string& what, NamedValue a = {}, NamedValue b = {}, std::int64_t c = 0,
                bool on_stack = false) {
    const auto [known, fresh] = roots_.try_emplace({what, a, b, c}, next_);
    if (fresh) {
      ++next_;
      on_stack_.push_back(on_stack);
    } else if (!on_stack) {
      on_stack_[known->second - argument_root - 1] = false;
    }
    return {known->second, 0};
  }
  [[nodiscard]] bool on_stack(NamedValue value) const {
    return value.root == stack_root ||
           (value.root > argument_root && on_stack_[value.root - argument_root - 1]);
  }
  void leave_stack(NamedValue value) {
    if (value.root > argument_root) on_stack_[value.root - argument_root - 1] = false;
  }

 private:
  std::map<Key, std::uint32_t> roots_;
  std::vector<bool> on_stack_;
  std::uint32_t next_ = argument_root + 1;
};

}  // namespace irt::symbols
