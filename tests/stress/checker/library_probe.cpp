// What the C++ library and the C library do to memory in compiled code is seen: each program whose
// fault is in there, and a healthy twin.

#include <atomic>
#include <cassert>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <future>
#include <list>
#include <map>
#include <memory>
#include <memory_resource>
#include <mutex>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

#include "tests/stress/checker/findings.hpp"

namespace {

using irt::findings::Program;

// --- Containers as queues ---------------------------------------------------------------------

std::mutex mutex;

template <class Container>
Container* container;

volatile int popped;

template <class Container>
void make() {
  container<Container> = new Container();
}
template <class Container>
void drop() {
  delete container<Container>;
}

void push(std::list<int>& c) {
  c.push_back(1);
}
void push(std::deque<int>& c) {
  c.push_back(1);
}
void push(std::set<int>& c) {
  c.insert(static_cast<int>(c.size()));
}
void push(std::map<int, int>& c) {
  c.emplace(static_cast<int>(c.size()), 1);
}
void push(std::unordered_map<int, int>& c) {
  c.emplace(static_cast<int>(c.size()), 1);
}
void push(std::string& c) {
  c.append("a text that does not fit into the object itself");
}
template <class Container>
void pop(Container& c) {
  if (!c.empty()) c.erase(c.begin());
}

template <class Container>
void push_locked() {
  const std::lock_guard lock(mutex);
  push(*container<Container>);
  push(*container<Container>);
}
template <class Container>
void pop_locked() {
  const std::lock_guard lock(mutex);
  pop(*container<Container>);
}
template <class Container>
void push_bare() {
  push(*container<Container>);
}
template <class Container>
void pop_bare() {
  pop(*container<Container>);
}

// --- Races that are in compiled code alone ----------------------------------------------------

using List = std::list<int>;
using Map = std::map<int, int>;
List::iterator in_list;
Map::iterator in_map;

void make_list() {
  container<List> = new List(2, 1);
  in_list = std::prev(container<List>->end());
}
void make_map() {
  container<Map> = new Map{{1, 1}, {2, 2}};
  in_map = container<Map>->begin();
}

char text[32] = "text";
std::string* message;
volatile std::size_t found;

// --- Healthy users of what sleeps and counts in compiled code -----------------------------------

std::once_flag once;
int made;
std::once_flag fails_once;
int attempts = 0;

// Who comes second makes another attempt, whether it has waited or not.
void try_to_make() {
  try {
    std::call_once(fails_once, [] {
      if (++attempts == 1) throw std::runtime_error("not yet");
    });
    assert(attempts == 2);
  } catch (const std::runtime_error&) {
    return;
  }
}

void make_once() {
  std::call_once(once, [] { made = 7; });
  assert(made == 7);
}

std::shared_ptr<int>* shared;
void drop_copy(int i) {
  shared[i].reset();
}

std::promise<int>* promise;

void set_errno(int value) {
  errno = value;
  assert(errno == value);
}

// --- The library's own functions do what they should --------------------------------------------

void check_tree(const std::_Rb_tree_node_base* node, int black, int& expected) {
  if (node == nullptr) {
    if (expected == -1) expected = black;
    assert(black == expected);
    return;
  }
  const bool red = node->_M_color == std::_S_red;
  for (const auto* child : {node->_M_left, node->_M_right}) {
    assert(child == nullptr || child->_M_parent == node);
    assert(!red || child == nullptr || child->_M_color == std::_S_black);
    check_tree(child, black + (red ? 0 : 1), expected);
  }
}

void trees_are_right() {
  std::set<unsigned> set;
  static bool in[64];
  unsigned seed = 1;
  for (int i = 0; i < 600; ++i) {
    seed = seed * 1664525 + 1013904223;
    const unsigned key = seed >> 26U;
    if (in[key])
      set.erase(key);
    else
      set.insert(key);
    in[key] = !in[key];
    int black = -1;
    const auto* header = set.end()._M_node;
    if (!set.empty()) check_tree(header->_M_parent, 0, black);
    auto at = set.begin();
    for (unsigned k = 0; k < 64; ++k)
      if (in[k]) assert(at != set.end() && *at++ == k);
    assert(at == set.end());
    for (unsigned k = 64; k-- > 0;)
      if (in[k]) assert(*--at == k);
  }
}

void lists_are_right() {
  List a{1, 2, 3};
  List b{4, 5};
  List none;
  a.swap(b);
  assert((a == List{4, 5} && b == List{1, 2, 3}));
  a.swap(none);
  assert((none == List{4, 5} && a.empty()));
  a.swap(none);
  a.splice(std::next(a.begin()), b, std::next(b.begin()), b.end());
  assert((a == List{4, 2, 3, 5} && b == List{1}));
  a.reverse();
  a.sort();
  a.remove(3);
  assert((a == List{2, 4, 5}));
  assert(*std::prev(a.end()) == 5 && *std::prev(std::prev(a.end())) == 4);
}

void resources_are_right() {
  std::pmr::monotonic_buffer_resource pieces(64);
  std::pmr::vector<int> numbers(&pieces);
  for (int i = 0; i < 100; ++i) numbers.push_back(i);
  std::pmr::list<int> list(numbers.begin(), numbers.end(), &pieces);
  for (const int i : list) assert(numbers[static_cast<unsigned>(i)] == i);
  assert(std::pmr::get_default_resource() == std::pmr::new_delete_resource());
  auto* far = static_cast<char*>(pieces.allocate(1000, 256));
  assert(reinterpret_cast<std::uintptr_t>(far) % 256 == 0);
  far[999] = 1;
}

void texts_are_right() {
  char a[16];
  char b[16] = "";
  assert(std::strcpy(a, "abc") == a && std::strlen(a) == 3);
  assert(stpcpy(b, a) == b + 3 && std::strcmp(a, b) == 0);
  std::strncpy(b, "xy", 4);
  assert(b[2] == 0 && b[3] == 0 && std::strncmp("xyz", b, 2) == 0);
  assert(std::strcat(a, b) == a && std::strcmp(a, "abcxy") == 0);
  assert(std::strncat(a, b + 4, 1) == a && a[5] == 0);
  assert(std::strchr(a, 'x') == a + 3 && std::strrchr(a, 'q') == nullptr);
  assert(std::memchr(a, 'y', 16) == a + 4 && std::strstr(a, "xy") == a + 3);
  assert(std::memcmp(a, "abd", 3) < 0 && std::strchr(a, 0) == a + 5);
  char* copy = strndup(a, 2);
  assert(std::strcmp(copy, "ab") == 0);
  std::free(copy);
  std::unordered_map<std::string, int> numbers;
  for (int i = 0; i < 40; ++i) numbers[std::to_string(i)] = i;
  for (int i = 0; i < 40; ++i) assert(numbers.at(std::to_string(i)) == i);
}

// --- Chance --------------------------------------------------------------------------------------

std::atomic<unsigned> dice[2];

void throw_dice() {
  const unsigned chance =
      std::random_device()() + static_cast<unsigned>(std::rand()) +
      static_cast<unsigned>(std::chrono::steady_clock::now().time_since_epoch().count());
  for (unsigned i = 0; i <= chance % 3; ++i) ++dice[chance >> i & 1U];
}

// The state of this one is the C library's, and goes on from one execution to the next.
void throw_foreign_dice() {
  const long chance = lrand48();
  for (long i = 0; i <= chance % 3; ++i) ++dice[chance >> i & 1];
  assert(chance % 64 != 5);
}

void no_work() {}

template <class Container>
constexpr Program locked(const char* name) {
  return {
      name, "", {push_locked<Container>, pop_locked<Container>}, make<Container>, drop<Container>};
}
template <class Container>
constexpr Program bare(const char* name) {
  return {name,
          "data race",
          {push_bare<Container>, pop_bare<Container>},
          make<Container>,
          drop<Container>};
}

const Program programs[] = {
    locked<std::list<int>>("list"),
    bare<std::list<int>>("list, no lock"),
    locked<std::deque<int>>("deque"),
    bare<std::deque<int>>("deque, no lock"),
    locked<std::set<int>>("set"),
    bare<std::set<int>>("set, no lock"),
    locked<std::map<int, int>>("map"),
    bare<std::map<int, int>>("map, no lock"),
    locked<std::unordered_map<int, int>>("unordered_map"),
    bare<std::unordered_map<int, int>>("unordered_map, no lock"),
    locked<std::string>("string"),
    bare<std::string>("string, no lock"),
    {"a link of a list",
     "data race",
     {[] { container<List>->push_back(2); }, [] { popped = std::next(in_list) == in_list; }},
     make_list,
     drop<List>},
    {"a link of a tree",
     "data race",
     {[] { container<Map>->emplace(3, 3); }, [] { popped = std::next(in_map)->second; }},
     make_map,
     drop<Map>},
    {"the length of a string",
     "data race",
     {push_bare<std::string>, [] { found = container<std::string>->size(); }},
     make<std::string>,
     drop<std::string>},
    {"a C string",
     "data race",
     {[] { std::strcpy(text, "other"); }, [] { found = std::strlen(text); }}},
    {"the text of an exception",
     "data race",
     {[] { message->front() = 'A'; },
      [] {
        try {
          throw std::runtime_error(*message);
        } catch (const std::exception& error) {
          popped = error.what()[0];
        }
      }},
     [] { message = new std::string("a text that does not fit into the object itself"); },
     [] { delete message; }},
    {"call_once", "", {make_once, make_once}},
    {"call_once that throws", "", {try_to_make, try_to_make}},
    {"shared_ptr",
     "",
     {[] { drop_copy(0); }, [] { drop_copy(1); }},
     [] {
       shared = new std::shared_ptr<int>[2];
       shared[0] = shared[1] = std::make_shared<int>(1);
     },
     [] { delete[] shared; }},
    {"shared_ptr as an atomic",
     "",
     {[] { std::atomic_store(shared, std::make_shared<int>(2)); },
      [] { assert(*std::atomic_load(shared) != 0); }},
     [] { shared = new std::shared_ptr<int>(std::make_shared<int>(1)); },
     [] { delete shared; }},
    {"future",
     "",
     {[] { promise->set_value(5); }, [] { assert(promise->get_future().get() == 5); }},
     [] { promise = new std::promise<int>; },
     [] { delete promise; }},
    {"errno", "", {[] { set_errno(1); }, [] { set_errno(2); }}},
    {"chance", "", {throw_dice, throw_dice}},
    {"trees", "", {trees_are_right, no_work}},
    {"lists", "", {lists_are_right, no_work}},
    {"memory resources", "", {resources_are_right, no_work}},
    {"texts", "", {texts_are_right, no_work}},
};

}  // namespace

extern "C" const Program* irt_foreign_dice() {
  static constexpr Program program{"foreign dice", "", {throw_foreign_dice, throw_foreign_dice}};
  return &program;
}

extern "C" const Program* irt_library_programs(unsigned* count) {
  *count = sizeof programs / sizeof *programs;
  return programs;
}
