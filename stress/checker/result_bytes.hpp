/// Results as bytes, from one process to another of the same program.
#pragma once

#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "stress/checker/checker.hpp"

namespace irt::checker {

/// Appends values.
struct Writer {
  std::string bytes{};

  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class T>
  void put_all(const T& values) {
    put(values.size());
    for (const auto& value : values) put(value);
  }
};

/// Takes them in the same order. Throws std::runtime_error where there are too few bytes.
struct Reader {
  const std::string& bytes;
  std::size_t at = 0;

  template <class T>
  T take() {
    T value;
    if (bytes.size() - at < sizeof value)
      throw std::runtime_error("a part of the search sent half a result");
    std::memcpy(&value, bytes.data() + at, sizeof value);
    at += sizeof value;
    return value;
  }
  template <class T>
  T take_all() {
    T values;
    for (auto left = take<std::size_t>(); left > 0; --left)
      values.push_back(take<typename T::value_type>());
    return values;
  }
};

std::string to_bytes(const Result& result);
Result from_bytes(const std::string& bytes);

}  // namespace irt::checker
