// Vectors whose new elements are not set to zero before they are written.
#pragma once
#include <memory>
#include <utility>
#include <vector>

namespace passo {

// `resize()` leaves new elements of a vector of these uninitialised.
template <typename T>
struct LeftUnset : std::allocator<T> {
  template <typename U>
  struct rebind {
    using other = LeftUnset<U>;
  };
  template <typename U, typename... Values>
  void construct(U* p, Values&&... values) {
    if constexpr (sizeof...(Values) > 0) std::construct_at(p, std::forward<Values>(values)...);
  }
};
using UnsetDoubles = std::vector<double, LeftUnset<double>>;

}  // namespace passo
