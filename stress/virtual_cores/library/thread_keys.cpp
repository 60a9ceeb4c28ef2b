// pthread_key_t and tss_t: values by key, each virtual core its own. The keys are variables of the
// module, so that an execution has none from the one before.

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <pthread.h>
#include <threads.h>

// Has `function` called at the end of the core, after the destructors of its thread_local objects.
extern "C" void irt_vc_at_end_of_core(void (*function)(void*));

namespace {

using Destructor = void (*)(void*);

// A key that is deleted and made anew has another number, so that old values do not count.
struct Key {
  std::atomic<std::uint32_t> number{0};  ///< even: nobody has it
  Destructor destructor = nullptr;
};
std::array<Key, PTHREAD_KEYS_MAX> keys;

struct Value {
  std::uint32_t number = 0;
  const void* value = nullptr;
};
struct Values {
  bool known_to_runtime = false;
  std::array<Value, PTHREAD_KEYS_MAX> of_key;
};
thread_local Values values;

bool in_use(std::uint32_t number) {
  return number % 2 != 0;
}

void destroy_values(void*) {
  bool again = true;
  for (int round = 0; again && round < PTHREAD_DESTRUCTOR_ITERATIONS; ++round) {
    again = false;
    for (std::size_t k = 0; k < keys.size(); ++k) {
      Value& mine = values.of_key[k];
      if (mine.value == nullptr) continue;
      const bool live = mine.number == keys[k].number.load(std::memory_order_acquire);
      auto* const value = const_cast<void*>(mine.value);
      mine.value = nullptr;
      if (!live || keys[k].destructor == nullptr) continue;
      again = true;
      keys[k].destructor(value);
    }
  }
}

}  // namespace

// NOLINTBEGIN(readability-identifier-naming)

extern "C" int pthread_key_create(pthread_key_t* key, Destructor destructor) {
  for (std::size_t k = 0; k < keys.size(); ++k) {
    std::uint32_t number = keys[k].number.load(std::memory_order_relaxed);
    if (in_use(number) ||
        !keys[k].number.compare_exchange_strong(number, number + 1, std::memory_order_acq_rel))
      continue;
    keys[k].destructor = destructor;
    *key = static_cast<pthread_key_t>(k);
    return 0;
  }
  return EAGAIN;
}

extern "C" int pthread_key_delete(pthread_key_t key) {
  if (key >= keys.size()) return EINVAL;
  std::uint32_t number = keys[key].number.load(std::memory_order_relaxed);
  const bool deleted = in_use(number) && keys[key].number.compare_exchange_strong(
                                             number, number + 1, std::memory_order_acq_rel);
  return deleted ? 0 : EINVAL;
}

extern "C" int pthread_setspecific(pthread_key_t key, const void* value) {
  if (key >= keys.size()) return EINVAL;
  const std::uint32_t number = keys[key].number.load(std::memory_order_relaxed);
  if (!in_use(number)) return EINVAL;
  if (!values.known_to_runtime) {
    values.known_to_runtime = true;
    irt_vc_at_end_of_core(destroy_values);
  }
  values.of_key[key] = {number, value};
  return 0;
}

extern "C" void* pthread_getspecific(pthread_key_t key) {
  if (key >= keys.size()) return nullptr;
  const Value& mine = values.of_key[key];
  if (mine.value == nullptr || mine.number != keys[key].number.load(std::memory_order_relaxed))
    return nullptr;
  return const_cast<void*>(mine.value);
}

extern "C" int tss_create(tss_t* key, tss_dtor_t destructor) {
  return pthread_key_create(key, destructor) == 0 ? thrd_success : thrd_error;
}
extern "C" void tss_delete(tss_t key) {
  pthread_key_delete(key);
}
extern "C" int tss_set(tss_t key, void* value) {
  return pthread_setspecific(key, value) == 0 ? thrd_success : thrd_error;
}
extern "C" void* tss_get(tss_t key) {
  return pthread_getspecific(key);
}
// NOLINTEND(readability-identifier-naming)
