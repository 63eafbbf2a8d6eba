// What a user's first program does with the installed library.
#include <cde/error.hpp>
#include <cstdio>

int main() {
  try {
    throw cde::Error(cde::ErrorCode::kTimeout, "the card did not answer");
  } catch (const cde::Error& e) {
    std::printf("%s\n", e.what());
    return cde::exit_status(e.code()) == 4 ? 0 : 1;
  }
}
