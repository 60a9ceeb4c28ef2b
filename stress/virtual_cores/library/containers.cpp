// The nodes of std::list, std::set and std::map. libstdc++ links and balances them in compiled code
// that no hook announces; on virtual cores a module has these functions instead, instrumented like
// the rest of it. They do what the C++ library's do to the same fields.

#include <list>
#include <map>
#include <utility>

// The names are libstdc++'s.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming,cert-dcl58-cpp)
namespace std {

namespace __detail {

// Circular lists with a sentinel that holds no element.
void _List_node_base::_M_hook(_List_node_base* const position) noexcept {
  _M_next = position;
  _M_prev = position->_M_prev;
  position->_M_prev->_M_next = this;
  position->_M_prev = this;
}

void _List_node_base::_M_unhook() noexcept {
  _M_prev->_M_next = _M_next;
  _M_next->_M_prev = _M_prev;
}

void _List_node_base::_M_transfer(_List_node_base* const first,
                                  _List_node_base* const last) noexcept {
  if (this == last || first == last) return;
  _List_node_base* const final = last->_M_prev;
  first->_M_prev->_M_next = last;
  last->_M_prev = first->_M_prev;
  first->_M_prev = _M_prev;
  final->_M_next = this;
  _M_prev->_M_next = first;
  _M_prev = final;
}

void _List_node_base::_M_reverse() noexcept {
  _List_node_base* node = this;
  do {
    std::swap(node->_M_next, node->_M_prev);
    node = node->_M_prev;
  } while (node != this);
}

void _List_node_base::swap(_List_node_base& x, _List_node_base& y) noexcept {
  const bool x_empty = x._M_next == &x;
  const bool y_empty = y._M_next == &y;
  if (x_empty && y_empty) return;
  std::swap(x._M_next, y._M_next);
  std::swap(x._M_prev, y._M_prev);
  // An empty list's links lead to its own sentinel.
  if (y_empty)
    x._M_next = x._M_prev = &x;
  else
    x._M_next->_M_prev = x._M_prev->_M_next = &x;
  if (x_empty)
    y._M_next = y._M_prev = &y;
  else
    y._M_next->_M_prev = y._M_prev->_M_next = &y;
}

}  // namespace __detail

// Red-black trees (Cormen et al., Introduction to Algorithms, chapter 13). The header's parent is
// the root, its left and right are the first and the last node; it is red, the root is black.
namespace {

using Node = _Rb_tree_node_base;
using Side = Node* Node::*;

Side opposite(Side side) {
  return side == &Node::_M_left ? &Node::_M_right : &Node::_M_left;
}

Side side_of(const Node* node, const Node* parent) {
  return parent->_M_left == node ? &Node::_M_left : &Node::_M_right;
}

bool is_black(const Node* node) {
  return node == nullptr || node->_M_color == _S_black;
}

// `next` takes the place of `node` below its parent.
void replace(const Node* node, Node* next, Node& header) {
  Node* const parent = node->_M_parent;
  if (header._M_parent == node)
    header._M_parent = next;
  else
    parent->*side_of(node, parent) = next;
  if (next != nullptr) next->_M_parent = parent;
}

// `node` goes down to `side`, its other child takes its place.
void rotate(Node* node, Side side, Node& header) {
  Node* const child = node->*opposite(side);
  Node* const inner = child->*side;
  node->*opposite(side) = inner;
  if (inner != nullptr) inner->_M_parent = node;
  replace(node, child, header);
  child->*side = node;
  node->_M_parent = child;
}

Node* step(Node* node, Side side) {
  if (node->*side != nullptr) {
    node = node->*side;
    while (node->*opposite(side) != nullptr) node = node->*opposite(side);
    return node;
  }
  Node* parent = node->_M_parent;
  while (node == parent->*side) {
    node = parent;
    parent = parent->_M_parent;
  }
  // From the root, which has nothing on that side, one is at the header already.
  return node->*side == parent ? node : parent;
}

// One black node is missing on the way to `node`, which may be null, below `parent`.
void restore_blackness(Node* node, Node* parent, Node& header) {
  while (node != header._M_parent && is_black(node)) {
    const Side side = side_of(node, parent);
    const Side other = opposite(side);
    Node* sibling = parent->*other;
    if (sibling->_M_color == _S_red) {
      sibling->_M_color = _S_black;
      parent->_M_color = _S_red;
      rotate(parent, side, header);
      sibling = parent->*other;
    }
    if (is_black(sibling->_M_left) && is_black(sibling->_M_right)) {
      sibling->_M_color = _S_red;
      node = parent;
      parent = parent->_M_parent;
      continue;
    }
    if (is_black(sibling->*other)) {
      (sibling->*side)->_M_color = _S_black;
      sibling->_M_color = _S_red;
      rotate(sibling, other, header);
      sibling = parent->*other;
    }
    sibling->_M_color = parent->_M_color;
    parent->_M_color = _S_black;
    (sibling->*other)->_M_color = _S_black;
    rotate(parent, side, header);
    return;
  }
  if (node != nullptr) node->_M_color = _S_black;
}

}  // namespace

Node* _Rb_tree_increment(Node* node) noexcept {
  return step(node, &Node::_M_right);
}
const Node* _Rb_tree_increment(const Node* node) noexcept {
  return step(const_cast<Node*>(node), &Node::_M_right);
}
Node* _Rb_tree_decrement(Node* node) noexcept {
  // The end is the header, whose right is the last node.
  if (node->_M_color == _S_red && node->_M_parent->_M_parent == node) return node->_M_right;
  return step(node, &Node::_M_left);
}
const Node* _Rb_tree_decrement(const Node* node) noexcept {
  return _Rb_tree_decrement(const_cast<Node*>(node));
}

void _Rb_tree_insert_and_rebalance(const bool left, Node* node, Node* parent,
                                   Node& header) noexcept {
  node->_M_parent = parent;
  node->_M_left = node->_M_right = nullptr;
  node->_M_color = _S_red;
  if (left) {
    parent->_M_left = node;
    if (parent == &header)
      header._M_parent = header._M_right = node;
    else if (parent == header._M_left)
      header._M_left = node;
  } else {
    parent->_M_right = node;
    if (parent == header._M_right) header._M_right = node;
  }
  while (node != header._M_parent && node->_M_parent->_M_color == _S_red) {
    parent = node->_M_parent;
    Node* const grandparent = parent->_M_parent;
    const Side side = side_of(parent, grandparent);
    Node* const uncle = grandparent->*opposite(side);
    if (!is_black(uncle)) {
      parent->_M_color = uncle->_M_color = _S_black;
      grandparent->_M_color = _S_red;
      node = grandparent;
      continue;
    }
    if (node == parent->*opposite(side)) {
      rotate(parent, side, header);
      parent = node;
    }
    parent->_M_color = _S_black;
    grandparent->_M_color = _S_red;
    rotate(grandparent, opposite(side), header);
    break;
  }
  header._M_parent->_M_color = _S_black;
}

Node* _Rb_tree_rebalance_for_erase(Node* const node, Node& header) noexcept {
  Node* child = nullptr;  // what takes the place that becomes free, below `parent`
  Node* parent = nullptr;
  if (node->_M_left != nullptr && node->_M_right != nullptr) {
    // The next node in order takes the place and the colour of `node`.
    Node* next = node->_M_right;
    while (next->_M_left != nullptr) next = next->_M_left;
    child = next->_M_right;
    parent = next;
    if (next != node->_M_right) {
      parent = next->_M_parent;
      parent->_M_left = child;
      if (child != nullptr) child->_M_parent = parent;
      next->_M_right = node->_M_right;
      next->_M_right->_M_parent = next;
    }
    next->_M_left = node->_M_left;
    next->_M_left->_M_parent = next;
    replace(node, next, header);
    std::swap(next->_M_color, node->_M_color);
  } else {
    child = node->_M_left != nullptr ? node->_M_left : node->_M_right;
    parent = node->_M_parent;
    if (header._M_left == node)
      header._M_left = child != nullptr ? Node::_S_minimum(child) : parent;
    if (header._M_right == node)
      header._M_right = child != nullptr ? Node::_S_maximum(child) : parent;
    replace(node, child, header);
  }
  if (node->_M_color == _S_black) restore_blackness(child, parent, header);
  return node;
}

}  // namespace std
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming,cert-dcl58-cpp)
