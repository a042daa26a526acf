// Between what makes a bound program and what runs it.
#pragma once

#include "rbvi/core/expression.hpp"

#include <array>

namespace rbvi {

constexpr int most_registers = 512;

double evaluated(Operation operation, const std::array<double, 3> &operands);

} // namespace rbvi
