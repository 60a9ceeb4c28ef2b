/// What ThreadSanitizer reports in the comparators and is not ours to mend. Boost.Lockfree reads a
/// task that may be overwritten and then discards it. oneTBB takes its pages from an allocator that
/// is not instrumented, so that their reuse looks like a race; with std::allocator there is none.

extern "C" const char* __tsan_default_suppressions();  // NOLINT

extern "C" const char* __tsan_default_suppressions() {  // NOLINT
  return "race:boost::lockfree\nrace:tbb::detail\n";
}
