// `irt bench micro` where Google Benchmark is missing.
#include <cstdio>

int main() {
  std::fputs("irt bench micro: Google Benchmark is missing; libbenchmark-dev brings it\n", stderr);
  return 2;
}
