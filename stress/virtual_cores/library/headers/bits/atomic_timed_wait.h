/// Waiting on atomic objects with a deadline: see atomic_wait.h.
#ifndef _GLIBCXX_ATOMIC_TIMED_WAIT_H
#define _GLIBCXX_ATOMIC_TIMED_WAIT_H 1
#pragma GCC system_header

#include <bits/atomic_wait.h>
#include <bits/chrono.h>

#define _GLIBCXX_HAVE_PLATFORM_TIMED_WAIT

namespace std _GLIBCXX_VISIBILITY(default) {
  _GLIBCXX_BEGIN_NAMESPACE_VERSION
  namespace __detail {

  /// The time that is left until a deadline, as a futex takes it.
  template <typename _Clock, typename _Dur>
  struct __left_until {
    chrono::time_point<_Clock, _Dur> __deadline;
    timespec __time{};

    const timespec* operator()() noexcept {
      const auto __rest = chrono::ceil<chrono::nanoseconds>(__deadline - _Clock::now());
      const auto __count = __rest.count() < 0 ? 0 : __rest.count();
      __time = {static_cast<time_t>(__count / 1'000'000'000),
                static_cast<long>(__count % 1'000'000'000)};
      return &__time;
    }
  };

  template <typename _Rep, typename _Period>
  auto __deadline_in(const chrono::duration<_Rep, _Period>& __rtime) noexcept {
    return chrono::steady_clock::now() + chrono::ceil<chrono::steady_clock::duration>(__rtime);
  }

  }  // namespace __detail

  template <typename _Tp, typename _Pred, typename _Clock, typename _Dur>
  _GLIBCXX_ALWAYS_INLINE bool __atomic_wait_address_until(
      const _Tp* __addr, _Pred __pred, const chrono::time_point<_Clock, _Dur>& __atime) noexcept {
    return __detail::__wait(__detail::__word_of(__addr), __pred,
                            __detail::__left_until<_Clock, _Dur>{__atime});
  }

  template <typename _Pred, typename _Clock, typename _Dur>
  _GLIBCXX_ALWAYS_INLINE bool __atomic_wait_address_until_bare(
      const __detail::__platform_wait_t* __addr, _Pred __pred,
      const chrono::time_point<_Clock, _Dur>& __atime) noexcept {
    return __detail::__wait(__addr, __pred, __detail::__left_until<_Clock, _Dur>{__atime});
  }

  template <typename _Tp, typename _ValFn, typename _Clock, typename _Dur>
  _GLIBCXX_ALWAYS_INLINE bool __atomic_wait_address_until_v(
      const _Tp* __addr, _Tp&& __old, _ValFn&& __vfn,
      const chrono::time_point<_Clock, _Dur>& __atime) noexcept {
    return std::__atomic_wait_address_until(
        __addr, [&] { return __detail::__differs<_Tp>(__vfn(), __old); }, __atime);
  }

  template <typename _Tp, typename _Pred, typename _Rep, typename _Period>
  _GLIBCXX_ALWAYS_INLINE bool __atomic_wait_address_for(
      const _Tp* __addr, _Pred __pred, const chrono::duration<_Rep, _Period>& __rtime) noexcept {
    return std::__atomic_wait_address_until(__addr, __pred, __detail::__deadline_in(__rtime));
  }

  template <typename _Pred, typename _Rep, typename _Period>
  _GLIBCXX_ALWAYS_INLINE bool __atomic_wait_address_for_bare(
      const __detail::__platform_wait_t* __addr, _Pred __pred,
      const chrono::duration<_Rep, _Period>& __rtime) noexcept {
    return std::__atomic_wait_address_until_bare(__addr, __pred, __detail::__deadline_in(__rtime));
  }

  template <typename _Tp, typename _ValFn, typename _Rep, typename _Period>
  _GLIBCXX_ALWAYS_INLINE bool __atomic_wait_address_for_v(
      const _Tp* __addr, _Tp&& __old, _ValFn&& __vfn,
      const chrono::duration<_Rep, _Period>& __rtime) noexcept {
    return std::__atomic_wait_address_until(
        __addr, [&] { return __detail::__differs<_Tp>(__vfn(), __old); },
        __detail::__deadline_in(__rtime));
  }

  _GLIBCXX_END_NAMESPACE_VERSION
}  // namespace )
#endif
