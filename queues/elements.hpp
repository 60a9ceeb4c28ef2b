/// Elements that are more than a word: what queues that claim to take them are tried with.
///
/// Each carries a word, and knows when it is no longer what it was made of.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>

namespace irt {

/// Sixty-four bytes, trivially copyable. Every part says which word it belongs to, so that an
/// element of which half is another one's is noticed.
class LargeElement {
 public:
  LargeElement() = default;
  explicit LargeElement(std::uint64_t word) {
    for (std::size_t i = 0; i < parts_.size(); ++i) parts_.at(i) = word + i;
  }

  /// Throws std::logic_error where the parts are not of one element.
  [[nodiscard]] std::uint64_t word() const {
    for (std::size_t i = 0; i < parts_.size(); ++i)
      if (parts_.at(i) != parts_.front() + i)
        throw std::logic_error("an element of 64 bytes came out in parts of several");
    return parts_.front();
  }

 private:
  std::array<std::uint64_t, 8> parts_{};
};

/// Moves and is never copied, as std::unique_ptr. What it owns is freed once, by whoever has it
/// last.
class OwnerElement {
 public:
  OwnerElement() = default;
  explicit OwnerElement(std::uint64_t word) : owned_(std::make_unique<std::uint64_t>(word)) {}

  [[nodiscard]] bool owns() const { return owned_ != nullptr; }
  /// Throws std::logic_error where it was moved from.
  [[nodiscard]] std::uint64_t word() const {
    if (!owns()) throw std::logic_error("an element came out that had been moved from");
    return *owned_;
  }

 private:
  std::unique_ptr<std::uint64_t> owned_;
};

/// The same, and may be copied at the price of memory, so that copying it may throw.
class CopiedElement : public OwnerElement {
 public:
  using OwnerElement::OwnerElement;
  CopiedElement(const CopiedElement& other)
      : OwnerElement(other.owns() ? OwnerElement(other.word()) : OwnerElement()) {}
  CopiedElement(CopiedElement&&) noexcept = default;
  CopiedElement& operator=(const CopiedElement& other) { return *this = CopiedElement(other); }
  CopiedElement& operator=(CopiedElement&&) noexcept = default;
  ~CopiedElement() = default;
};

}  // namespace irt
