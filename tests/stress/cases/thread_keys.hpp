/// Bags that count, for each thread, what it has pushed, in memory that it finds by a key of the C
/// library.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <pthread.h>
#include <string_view>
#include <threads.h>

#include "queues/blocking/mutex_queue.hpp"
#include "queues/work_queue.hpp"

namespace irt {

class PosixKey {
 public:
  explicit PosixKey(void (*destructor)(void*)) { pthread_key_create(&key_, destructor); }
  PosixKey(const PosixKey&) = delete;
  PosixKey& operator=(const PosixKey&) = delete;
  ~PosixKey() { pthread_key_delete(key_); }

  [[nodiscard]] void* get() const { return pthread_getspecific(key_); }
  void set(void* value) const { pthread_setspecific(key_, value); }

 private:
  pthread_key_t key_{};
};

class C11Key {
 public:
  explicit C11Key(void (*destructor)(void*)) { tss_create(&key_, destructor); }
  C11Key(const C11Key&) = delete;
  C11Key& operator=(const C11Key&) = delete;
  ~C11Key() { tss_delete(key_); }

  [[nodiscard]] void* get() const { return tss_get(key_); }
  void set(void* value) const { tss_set(key_, value); }

 private:
  tss_t key_{};
};

/// `frees`: at the end of a thread its count is freed.
template <class T, class Key, bool frees = true>
class KeyedBag {
 public:
  static constexpr std::string_view summary = "a bag whose threads count by a key";
  static constexpr Claims claims{.survives_no_memory = false};

  KeyedBag(unsigned workers, std::size_t capacity)
      : key_(frees ? &std::free : nullptr), tasks_(workers, capacity) {}

  bool push(unsigned worker, T task) {
    auto* pushed = static_cast<unsigned*>(key_.get());
    if (pushed == nullptr) {
      pushed = static_cast<unsigned*>(std::calloc(1, sizeof *pushed));
      if (pushed == nullptr) return false;
      key_.set(pushed);
    }
    ++*pushed;
    return tasks_.push(worker, task);
  }

  bool pop(unsigned worker, T& task) { return tasks_.pop(worker, task); }

 private:
  Key key_;
  MutexQueue<T> tasks_;
};

template <class T>
using PosixKeyBag = KeyedBag<T, PosixKey>;
template <class T>
using C11KeyBag = KeyedBag<T, C11Key>;
template <class T>
using PosixKeyLeaksBug = KeyedBag<T, PosixKey, false>;

}  // namespace irt
