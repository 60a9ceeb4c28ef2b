/// What the user may have meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace irt {

/// The candidate with the fewest insertions, deletions, substitutions and swaps of neighbours from
/// `name` (Damerau 1964, restricted); the first of several. Empty where none is near: more than a
/// third of `name`, and more than one letter, would have to change.
std::string_view nearest(std::string_view name, std::span<const std::string_view> candidates);

/// One line for a name that is not among the candidates: what was given, what may have been meant,
/// what there is. `kind` is what it should have named, for example "queue".
std::string unknown_name(std::string_view kind, std::string_view name,
                         std::span<const std::string_view> candidates);

}  // namespace irt
