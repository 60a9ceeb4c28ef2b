#include "stress/virtual_cores/harmless.hpp"

#include <algorithm>
#include <array>
#include <iterator>

namespace irt::virtual_cores {

namespace {

using namespace std::string_view_literals;

// What the compiler and the linker put into every module, and the C++ ABI of exceptions and types.
constexpr std::array exact{
    "__gmon_start__"sv, "_ITM_registerTMCloneTable"sv, "_ITM_deregisterTMCloneTable"sv,
    "__cxa_finalize"sv, "__dso_handle"sv, "__stack_chk_fail"sv, "__gxx_personality_v0"sv,
    "_Unwind_Resume"sv, "__cxa_allocate_exception"sv, "__cxa_free_exception"sv, "__cxa_throw"sv,
    "__cxa_rethrow"sv, "__cxa_begin_catch"sv, "__cxa_end_catch"sv, "__cxa_get_exception_ptr"sv,
    "__cxa_init_primary_exception"sv, "_ZSt11__once_call"sv, "_ZSt15__once_callable"sv,
    "__cxa_call_unexpected"sv, "__cxa_pure_virtual"sv, "__cxa_deleted_virtual"sv,
    "__cxa_bad_cast"sv, "__cxa_bad_typeid"sv, "__cxa_throw_bad_array_new_length"sv,
    // std::nothrow, get_new_handler, uncaught_exception(s), ios_base::Init.
    "_ZSt7nothrow"sv, "_ZSt15get_new_handlerv"sv, "_ZSt18uncaught_exceptionv"sv,
    "_ZSt19uncaught_exceptionsv"sv, "_ZNSt8ios_base4InitC1Ev"sv, "_ZNSt8ios_base4InitD1Ev"sv,
    // std::_Sp_make_shared_tag, std::type_info.
    "_ZNSt19_Sp_make_shared_tag5_S_eqERKSt9type_info"sv, "_ZNKSt9type_infoeqERKS_"sv,
    "_ZNSt9type_infoeqERKS_"sv, "_ZNKSt9type_info6beforeERKS_"sv,
    // std::generic_category, std::system_category, std::future_category.
    "_ZNSt3_V216generic_categoryEv"sv, "_ZNSt3_V215system_categoryEv"sv, "_ZSt15future_categoryv"sv,
    // The standard streams, which may be shared, and what the library has in common for all
    // streams.
    "_ZSt3cin"sv, "_ZSt4cout"sv, "_ZSt4cerr"sv, "_ZSt4clog"sv, "stdin"sv, "stdout"sv, "stderr"sv,
    "_ZNKSt5ctypeIcE13_M_widen_initEv"sv, "_ZNSt5ctypeIcE2idE"sv, "__dynamic_cast"sv,
    "__uselocale"sv, "fflush"sv, "putchar"sv, "fputc"sv, "putc"sv, "setvbuf"sv, "setbuf"sv,
    "_ZNSt10__num_base12_S_atoms_outE"sv, "_ZNSt10__num_base11_S_atoms_inE"sv,
    "_ZNSt10__num_base15_S_format_floatERKSt8ios_basePcc"sv,
    "_ZNSt6locale5_Impl16_M_install_cacheEPKNS_5facetEm"sv,
    "_ZNSt6locale5facet15_S_get_c_localeEv"sv, "_ZNSt6locale5facetD2Ev"sv,
    "_ZNKSt6locale2id5_M_idEv"sv,
    // Exceptions that are kept and thrown again elsewhere: who hands them over synchronises.
    "_ZSt17current_exceptionv"sv, "_ZSt17rethrow_exceptionNSt15__exception_ptr13exception_ptrE"sv,
    // Threads, and what the machine has.
    "_ZNSt6thread6_StateD1Ev"sv, "_ZNSt6thread6_StateD2Ev"sv, "_ZTVNSt6thread6_StateE"sv,
    "pthread_attr_init"sv, "pthread_attr_destroy"sv, "pthread_attr_setdetachstate"sv,
    "pthread_attr_getdetachstate"sv, "pthread_attr_setstacksize"sv, "pthread_attr_setscope"sv,
    "sysconf"sv, "get_nprocs"sv, "get_nprocs_conf"sv, "getpid"sv, "getpagesize"sv,
    "pthread_equal"sv, "thrd_equal"sv, "mlock"sv, "mlock2"sv, "munlock"sv, "posix_madvise"sv,
    "__sched_cpucount"sv, "getenv"sv,
    // Wide arithmetic.
    "__udivti3"sv, "__umodti3"sv, "__divti3"sv, "__modti3"sv, "__multi3"sv, "__popcountdi2"sv,
    "__atomic_is_lock_free"sv};

// std::__throw_...(text), by the length of the name before it.
bool is_throw_helper(std::string_view name) {
  if (!name.starts_with("_ZSt")) return false;
  name.remove_prefix(4);
  const std::size_t digits = name.find_first_not_of("0123456789");
  return digits != 0 && digits != std::string_view::npos &&
         name.substr(digits).starts_with("__throw_");
}

// Members of the exceptions that read no memory but their own: what(), destructors, copies. The
// text they are made with is announced (standard_library.cpp).
bool is_exception_member(std::string_view name) {
  static constexpr std::array classes{"9exception"sv,          "13bad_exception"sv,
                                      "9bad_alloc"sv,          "20bad_array_new_length"sv,
                                      "8bad_cast"sv,           "10bad_typeid"sv,
                                      "17bad_function_call"sv, "12bad_weak_ptr"sv,
                                      "11logic_error"sv,       "12domain_error"sv,
                                      "16invalid_argument"sv,  "12length_error"sv,
                                      "12out_of_range"sv,      "13runtime_error"sv,
                                      "11range_error"sv,       "14overflow_error"sv,
                                      "15underflow_error"sv,   "12system_error"sv,
                                      "12future_error"sv};
  static constexpr std::array members{"4whatEv"sv, "D0Ev"sv,   "D1Ev"sv,    "D2Ev"sv,
                                      "C1Ev"sv,    "C2Ev"sv,   "C1ERKS_"sv, "C2ERKS_"sv,
                                      "C1EOS_"sv,  "C2EOS_"sv, "aSERKS_"sv, "aSEOS_"sv};
  const bool table = name.starts_with("_ZTVSt");
  std::size_t begin = 0;
  for (const std::string_view prefix : {"_ZTVSt"sv, "_ZNKSt"sv, "_ZNSt"sv})
    if (name.starts_with(prefix)) begin = prefix.size();
  if (begin == 0) return false;
  const std::string_view rest = name.substr(begin);
  return std::ranges::any_of(classes, [&](std::string_view type) {
    if (!rest.starts_with(type)) return false;
    const std::string_view member = rest.substr(type.size());
    return table ? member.empty() : std::ranges::find(members, member) != members.end();
  });
}

// Functions of <cmath> that write to no argument; they may set errno, which is a core's own.
bool is_arithmetic(std::string_view name) {
  static constexpr std::array functions{
      "acos"sv,  "asin"sv,   "atan"sv,      "atan2"sv,   "cbrt"sv,  "ceil"sv,  "cos"sv,   "cosh"sv,
      "exp"sv,   "exp2"sv,   "expm1"sv,     "fabs"sv,    "floor"sv, "fma"sv,   "fmax"sv,  "fmin"sv,
      "fmod"sv,  "hypot"sv,  "ldexp"sv,     "llround"sv, "log"sv,   "log10"sv, "log1p"sv, "log2"sv,
      "lrint"sv, "lround"sv, "nearbyint"sv, "pow"sv,     "rint"sv,  "round"sv, "sin"sv,   "sinh"sv,
      "sqrt"sv,  "tan"sv,    "tanh"sv,      "trunc"sv};
  const auto known = [](std::string_view n) {
    return std::ranges::find(functions, n) != functions.end();
  };
  return known(name) ||
         ((name.ends_with('f') || name.ends_with('l')) && known(name.substr(0, name.size() - 1)));
}

}  // namespace

bool is_harmless(std::string_view name) {
  static constexpr std::array prefixes{
      "__tsan_"sv, "irt_vc_"sv, "_ZNSt15__exception_ptr13exception_ptr"sv,
      "_ZNKSt15__exception_ptr13exception_ptr"sv, "_ZTI"sv, "_ZTS"sv, "_ZTVN10__cxxabiv1"sv,
      // Attributes, which are made before the object and then read.
      "pthread_mutexattr_"sv, "pthread_condattr_"sv, "pthread_rwlockattr_"sv,
      "pthread_barrierattr_"sv, "pthread_attr_"sv};
  return std::ranges::any_of(
             prefixes, [name](std::string_view prefix) { return name.starts_with(prefix); }) ||
         std::ranges::find(exact, name) != exact.end() || is_throw_helper(name) ||
         is_exception_member(name) || is_arithmetic(name);
}

}  // namespace irt::virtual_cores
