// SPDX-License-Identifier: Apache-2.0
// The precompiled headers of the tests are built from this file (CMakeLists.txt).
int main() {}
