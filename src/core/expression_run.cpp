#include "expression_operations.hpp"
#include "expression_program.hpp"

#include <algorithm>
#include <array>

namespace rbvi {

namespace {

using Step = ProgramStep;

template <class Work, class F> void without_slopes(const Work &work, const F &f) {
  if constexpr (std::is_invocable_v<F, double>)
    work.unary(f, 0);
  else
    work.binary(f, 0);
}

/// A register holds a value.
struct ValueStep {
  double *registers;
  const Step &step;
  template <class F, class Slope> void unary(const F &f, const Slope &) const {
    registers[step.target] = f(registers[step.a]);
  }
  template <class F, class Slopes> void binary(const F &f, const Slopes &) const {
    registers[step.target] = f(registers[step.a], registers[step.b]);
  }
  template <class F> void jump(const F &f) const { without_slopes(*this, f); }
  template <class First> void pick(const First &first) const {
    const double a = registers[step.a], b = registers[step.b];
    registers[step.target] = first(a, b) ? a : b;
  }
  void choose() const {
    registers[step.target] = registers[registers[step.c] != 0 ? step.b : step.a];
  }
};

constexpr std::size_t block_size = 32, vector_size = 4;

/// A register holds the values at some points. That of a result is none of an operand.
struct BlockStep {
  std::array<double, block_size> *registers;
  std::size_t vectors; ///< of points
  const Step &step;
  template <class F, class Slope> void unary(const F &f, const Slope &) const {
    double *__restrict to = registers[step.target].data();
    const double *a = registers[step.a].data();
    for (std::size_t i = 0; i < vector_size * vectors; ++i)
      to[i] = f(a[i]);
  }
  template <class F, class Slopes> void binary(const F &f, const Slopes &) const {
    double *__restrict to = registers[step.target].data();
    const double *a = registers[step.a].data(), *b = registers[step.b].data();
    for (std::size_t i = 0; i < vector_size * vectors; ++i)
      to[i] = f(a[i], b[i]);
  }
  template <class F> void jump(const F &f) const { without_slopes(*this, f); }
  template <class First> void pick(const First &first) const {
    binary([&](double a, double b) { return first(a, b) ? a : b; }, 0);
  }
  void choose() const {
    double *__restrict to = registers[step.target].data();
    const double *otherwise = registers[step.a].data(), *if_so = registers[step.b].data(),
                 *condition = registers[step.c].data();
    for (std::size_t i = 0; i < vector_size * vectors; ++i)
      to[i] = condition[i] != 0 ? if_so[i] : otherwise[i];
  }
};

constexpr int derivatives_at_once = 8;

struct Varied {
  double value;
  std::array<double, derivatives_at_once> by;
};

/// A register holds a value with some of its derivatives. What does not vary adds none, even by an
/// infinite slope.
struct VariedStep {
  Varied *registers;
  const Step &step;
  template <class F, class Slope> void unary(const F &f, const Slope &slope) const {
    const Varied &a = registers[step.a];
    Varied &to = registers[step.target];
    to.value = f(a.value);
    const double factor = slope(a.value, to.value);
    for (int i = 0; i < derivatives_at_once; ++i)
      to.by[i] = a.by[i] == 0 ? 0 : factor * a.by[i];
  }
  template <class F, class Slopes> void binary(const F &f, const Slopes &slopes) const {
    const Varied &a = registers[step.a], &b = registers[step.b];
    Varied &to = registers[step.target];
    to.value = f(a.value, b.value);
    const auto [by_a, by_b] = slopes(a.value, b.value, to.value);
    for (int i = 0; i < derivatives_at_once; ++i)
      to.by[i] = (a.by[i] == 0 ? 0 : by_a * a.by[i]) + (b.by[i] == 0 ? 0 : by_b * b.by[i]);
  }
  template <class F> void jump(const F &f) const {
    Varied &to = registers[step.target];
    if constexpr (std::is_invocable_v<F, double>)
      to.value = f(registers[step.a].value);
    else
      to.value = f(registers[step.a].value, registers[step.b].value);
    to.by = {};
  }
  template <class First> void pick(const First &first) const {
    const Varied &a = registers[step.a], &b = registers[step.b];
    registers[step.target] = first(a.value, b.value) ? a : b;
  }
  void choose() const {
    registers[step.target] = registers[registers[step.c].value != 0 ? step.b : step.a];
  }
};

void run(const std::vector<Step> &steps, double *registers) {
  for (const Step &step : steps)
    with_operation(step.operation, ValueStep{registers, step});
}

void run(const std::vector<Step> &steps, Varied *registers) {
  for (const Step &step : steps)
    with_operation(step.operation, VariedStep{registers, step});
}

} // namespace

double evaluated(Operation operation, const std::array<double, 3> &operands) {
  std::array<double, 4> registers{operands[0], operands[1], operands[2]};
  with_operation(operation, ValueStep{registers.data(), Step{operation, 3, 0, 1, 2}});
  return registers[3];
}

void BoundProgram::values(const double *parameters, const double *coordinates, std::size_t count,
                          double *results) const {
  std::array<double, most_registers> registers; // not initialised, as those below
  std::copy(constants_.begin(), constants_.end(), registers.begin());
  std::copy_n(parameters, parameters_, registers.begin() + constants_.size());
  run(fixed_, registers.data());
  if (count != 1) return values_in_blocks(registers.data(), coordinates, count, results);
  std::copy_n(coordinates, coordinates_, registers.begin() + first_coordinate_);
  run(steps_, registers.data());
  for (std::size_t k = 0; k < results_.size(); ++k)
    results[k] = registers[results_[k]];
}

void BoundProgram::values_in_blocks(const double *start, const double *coordinates,
                                    std::size_t count, double *results) const {
  std::array<std::array<double, block_size>, most_registers> registers;
  for (int i = 0; i < first_coordinate_; ++i)
    registers[i].fill(start[i]);
  for (std::size_t first = 0; first < count; first += block_size) {
    const std::size_t points = std::min(block_size, count - first);
    const std::size_t vectors = (points + vector_size - 1) / vector_size;
    for (int k = 0; k < coordinates_; ++k) {
      auto &target = registers[first_coordinate_ + k];
      std::copy_n(coordinates + static_cast<std::size_t>(k) * count + first, points,
                  target.begin());
      std::fill(target.begin() + points, target.begin() + vector_size * vectors, target[0]);
    }
    for (const Step &step : steps_)
      with_operation(step.operation, BlockStep{registers.data(), vectors, step});
    for (std::size_t k = 0; k < results_.size(); ++k)
      std::copy_n(registers[results_[k]].begin(), points, results + k * count + first);
  }
}

void BoundProgram::values_and_gradients(const double *parameters, const double *coordinates,
                                        std::size_t count, double *results,
                                        double *gradients) const {
  std::array<Varied, most_registers> registers;
  for (std::size_t i = 0; i < constants_.size(); ++i)
    registers[i] = {constants_[i], {}};
  int first = 0; // of the derivatives that are computed at once
  const auto set = [&](std::size_t target, int name, double value) {
    registers[target] = {value, {}};
    const int slot = slots_[name] - first;
    if (slot >= 0 && slot < derivatives_at_once) registers[target].by[slot] = 1;
  };
  do {
    for (int k = 0; k < parameters_; ++k)
      set(constants_.size() + k, k, parameters[k]);
    run(fixed_, registers.data());
    const int wanted = std::min(derivatives_at_once, gradient_size_ - first);
    for (std::size_t point = 0; point < count; ++point) {
      for (int k = 0; k < coordinates_; ++k)
        set(first_coordinate_ + k, parameters_ + k, coordinates[k * count + point]);
      run(steps_, registers.data());
      for (std::size_t k = 0; k < results_.size(); ++k) {
        const Varied &result = registers[results_[k]];
        results[k * count + point] = result.value;
        for (int i = 0; i < wanted; ++i)
          gradients[(k * gradient_size_ + first + i) * count + point] = result.by[i];
      }
    }
    first += derivatives_at_once;
  } while (first < gradient_size_);
}

} // namespace rbvi
