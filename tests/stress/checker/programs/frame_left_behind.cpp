// finds: use after return
// a thread that nobody joins writes a variable of the function that began it
#include <thread>

void begin() {
  int done = 0;
  std::thread([&done] { done = 1; }).detach();
}

int main() {
  begin();
  return 0;
}
