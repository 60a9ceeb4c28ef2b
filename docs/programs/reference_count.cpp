// finds with -DWRONG: use after free | data race
#include <atomic>
#include <thread>

struct Picture {
  std::atomic<int> owners{2};
  int pixel = 0;
};

void release(Picture* picture) {
#if defined(WRONG)
  if (picture->owners.fetch_sub(1, std::memory_order_relaxed) == 1) delete picture;
#else
  // What each owner did comes before the end, which the last one sees to.
  if (picture->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete picture;
#endif
}

int main() {
  auto* const picture = new Picture;
  std::thread painter([picture] {
    picture->pixel = 255;
    release(picture);
  });
  release(picture);
  painter.join();
  return 0;
}
