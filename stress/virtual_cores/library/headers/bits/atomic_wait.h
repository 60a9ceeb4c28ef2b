/// Waiting on atomic objects, for code on virtual cores, in place of libstdc++'s own header of this
/// name (GCC 12).
///
/// That one counts waiters so that a notification without any needs no system call, looks at the
/// count by an order that C++ does not allow to rely on (a wake-up may be lost but for what
/// machines do), and looks many times before it sleeps. None of it is the code's doing. Here
/// whoever waits looks once and sleeps, and whoever notifies wakes: to the code the same, and far
/// fewer executions. All is inlined, so that its places are those of the code that calls it.
#ifndef _GLIBCXX_ATOMIC_WAIT_H
#define _GLIBCXX_ATOMIC_WAIT_H 1
#pragma GCC system_header

#include <bits/c++config.h>
#include <bits/functional_hash.h>
#include <bits/gthr.h>
#include <bits/std_mutex.h>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <ctime>
#include <ext/numeric_traits.h>
#include <linux/futex.h>
#include <sys/syscall.h>
#include <type_traits>
#include <unistd.h>

#define __cpp_lib_atomic_wait 201907L

namespace std _GLIBCXX_VISIBILITY(default) {
  _GLIBCXX_BEGIN_NAMESPACE_VERSION
  namespace __detail {

#define _GLIBCXX_HAVE_PLATFORM_WAIT 1
  using __platform_wait_t = int;
  inline constexpr size_t __platform_wait_alignment = 4;

  inline void __thread_yield() noexcept {
    __gthread_yield();
  }
  inline void __thread_relax() noexcept {
    __builtin_ia32_pause();
  }

  /// One look is as good as many.
  template <typename _Pred>
  _GLIBCXX_ALWAYS_INLINE bool __atomic_spin(_Pred& __pred) noexcept {
    return __pred();
  }

  /// What is slept on for objects that are no four bytes. There are many, for whoever shares one is
  /// woken for nothing.
  inline constinit __platform_wait_t __words[256] = {};

  template <typename _Tp>
  inline constexpr bool __is_word = is_scalar_v<_Tp> && sizeof(_Tp) == sizeof(__platform_wait_t);

  template <typename _Tp>
  _GLIBCXX_ALWAYS_INLINE __platform_wait_t* __word_of(const _Tp* __addr) noexcept {
    const auto __address = reinterpret_cast<uintptr_t>(__addr);
    if constexpr (__is_word<_Tp>)
      return reinterpret_cast<__platform_wait_t*>(__address);
    else
      return &__words[(__address ^ __address >> 8 ^ __address >> 16) % 256];
  }

  /// False if the time, where one is given, was over.
  _GLIBCXX_ALWAYS_INLINE bool __sleep(const __platform_wait_t* __word, __platform_wait_t __seen,
                                      const timespec* __time) noexcept {
    return syscall(SYS_futex, __word, FUTEX_WAIT_PRIVATE, __seen, __time) == 0 ||
           errno != ETIMEDOUT;
  }

  /// Whether `__done()` came in time; `__left()` is the time to wait, null for ever.
  template <typename _Done, typename _Left>
  _GLIBCXX_ALWAYS_INLINE bool __wait(const __platform_wait_t* __word, _Done __done,
                                     _Left __left) noexcept {
    for (;;) {
      // Before it is looked whether to wait: what changes after that changes this, too.
      const __platform_wait_t __seen = __atomic_load_n(__word, __ATOMIC_SEQ_CST);
      if (__done()) return true;
      if (!__sleep(__word, __seen, __left())) return __done();
    }
  }

  _GLIBCXX_ALWAYS_INLINE const timespec* __for_ever() noexcept {
    return nullptr;
  }

  template <typename _Tp>
  _GLIBCXX_ALWAYS_INLINE bool __differs(const _Tp& __a, const _Tp& __b) noexcept {
    return __builtin_memcmp(&__a, &__b, sizeof(_Tp)) != 0;
  }

  }  // namespace __detail

  template <typename _Tp, typename _ValFn>
  _GLIBCXX_ALWAYS_INLINE void __atomic_wait_address_v(const _Tp* __addr, _Tp __old,
                                                      _ValFn __vfn) noexcept {
    if constexpr (__detail::__is_word<_Tp>) {
      __detail::__platform_wait_t __seen;
      __builtin_memcpy(&__seen, &__old, sizeof __seen);
      while (!__detail::__differs<_Tp>(__vfn(), __old))
        __detail::__sleep(__detail::__word_of(__addr), __seen, nullptr);
    } else {
      __detail::__wait(
          __detail::__word_of(__addr), [&] { return __detail::__differs<_Tp>(__vfn(), __old); },
          __detail::__for_ever);
    }
  }

  template <typename _Tp, typename _Pred>
  _GLIBCXX_ALWAYS_INLINE void __atomic_wait_address(const _Tp* __addr, _Pred __pred) noexcept {
    __detail::__wait(__detail::__word_of(__addr), __pred, __detail::__for_ever);
  }

  template <typename _Pred>
  _GLIBCXX_ALWAYS_INLINE void __atomic_wait_address_bare(const __detail::__platform_wait_t* __addr,
                                                         _Pred __pred) noexcept {
    __detail::__wait(__addr, __pred, __detail::__for_ever);
  }

  template <typename _Tp>
  _GLIBCXX_ALWAYS_INLINE void __atomic_notify_address(const _Tp* __addr, bool __all) noexcept {
    __detail::__platform_wait_t* const __word = __detail::__word_of(__addr);
    if constexpr (!__detail::__is_word<_Tp>) {
      __atomic_fetch_add(__word, 1, __ATOMIC_SEQ_CST);
      __all = true;  // the one who is woken may wait for another object
    }
    syscall(SYS_futex, __word, FUTEX_WAKE_PRIVATE, __all ? INT_MAX : 1);
  }

  _GLIBCXX_ALWAYS_INLINE void __atomic_notify_address_bare(
      const __detail::__platform_wait_t* __addr, bool __all) noexcept {
    syscall(SYS_futex, __addr, FUTEX_WAKE_PRIVATE, __all ? INT_MAX : 1);
  }

  _GLIBCXX_END_NAMESPACE_VERSION
}  // namespace )
#endif
