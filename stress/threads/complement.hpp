/// The words that usual elements never use: their complements, with all high bits set.
///
/// A queue may keep words for itself, or bits of them, only if it says so. Elements are small
/// numbers; a queue that hides a mark in the upper bits, or takes the word of ones for a free
/// place, would never be found out.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "stress/scenarios/core.hpp"

namespace irt::stress {

/// The complement of what a queue with these claims may be given; its own inverse.
class Complement {
 public:
  explicit Complement(const Claims& claims) : used_(~claims.unused_bits) {}

  [[nodiscard]] Element operator()(Element e) const { return e ^ used_; }

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
    return restored(e, [&](Element& word) { return queue_->pop(worker, word); });
  }

  bool pop_wait(unsigned worker, Element& e) override {
    return restored(e, [&](Element& word) { return queue_->pop_wait(worker, word); });
  }
  PopStatus pop_wait(unsigned worker, Element& e, Deadline deadline) override {
    PopStatus status = PopStatus::closed;
    restored(e, [&](Element& word) {
      status = queue_->pop_wait(worker, word, deadline);
      return status == PopStatus::success;
    });
    return status;
  }
  void close() override { queue_->close(); }

  std::size_t push_bulk(unsigned worker, std::span<const Element> elements) override {
    std::vector<Element> words(elements.begin(), elements.end());
    for (Element& word : words) word = complement_(word);
    return queue_->push_bulk(worker, words);
  }
  std::size_t pop_bulk(unsigned worker, std::span<Element> elements) override {
    const std::size_t count = queue_->pop_bulk(worker, elements);
    for (Element& e : elements.first(std::min(count, elements.size()))) e = complement_(e);
    return count;
  }

  void leave(unsigned worker) override { queue_->leave(worker); }

 private:
  template <class Pop>
  bool restored(Element& e, Pop pop) {
    Element word = complement_(e);
    if (!pop(word)) return false;
    e = complement_(word);
    return true;
  }

  std::unique_ptr<ElementQueue> queue_;
  Complement complement_;
};

}  // namespace irt::stress
