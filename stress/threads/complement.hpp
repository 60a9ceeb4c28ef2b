/// The words that usual elements never use: their complements, with all high bits set.
///
/// A queue may keep words for itself, or bits of them, only if it says so. Elements are small
/// numbers; a queue that hides a mark in the upper bits, or takes the word of ones for a free
/// place, would never be found out.
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "stress/scenarios/core.hpp"

namespace irt::stress {

/// The complement of what a queue with these claims may be given; its own inverse. `close_word`,
/// which queues whose pop waits are given, stays what it is, and so nothing becomes it.
class Complement {
 public:
  explicit Complement(const Claims& claims) : used_(~claims.unused_bits) {}

  [[nodiscard]] Element operator()(Element e) const {
    const Element complement = e ^ used_;
    return e == close_word || complement == close_word ? e : complement;
  }

  /// What a queue that claims `claims` promises to whoever sees it through the complement; none if
  /// that cannot be said.
  [[nodiscard]] std::optional<Claims> seen(const Claims& claims) const {
    Claims through = claims;
    for (std::size_t i = 0; i < claims.reserved.count; ++i)
      through.reserved.words.at(i) = (*this)(claims.reserved.words.at(i));
    through.all_ones_reserved = false;
    if (claims.all_ones_reserved && claims.unused_bits == 0) {
      if (through.reserved.count == through.reserved.words.size()) return std::nullopt;
      through.reserved.words.at(through.reserved.count++) = (*this)(~Element{0});
    }
    return through;
  }

 private:
  Element used_;
};

/// A queue that is given the complements of what is pushed here.
class ComplementQueue final : public ElementQueue {
 public:
  ComplementQueue(std::unique_ptr<ElementQueue> queue, const Complement& complement)
      : queue_(std::move(queue)), complement_(complement) {}

  bool push(unsigned worker, Element e) override { return queue_->push(worker, complement_(e)); }
  bool pop(unsigned worker, Element& e) override {
    Element word = complement_(e);
    if (!queue_->pop(worker, word)) return false;
    e = complement_(word);
    return true;
  }

 private:
  std::unique_ptr<ElementQueue> queue_;
  Complement complement_;
};

}  // namespace irt::stress
