#include "cases.hpp"
namespace cde::oracle {
Case detail::ray_case(Pair, std::uint64_t, std::uint64_t) {
  throw 1;
}
}  // namespace cde::oracle
