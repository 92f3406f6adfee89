/* Headers of the standard library that many C++ files of tests include. The Makefile compiles them once, because
 * parsing them takes a third of the compiler's time for such a file. Files include what they use all the same. */
#ifndef SHEEN_TESTS_STANDARD_HPP
#define SHEEN_TESTS_STANDARD_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#endif
