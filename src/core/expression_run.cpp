#include "expression_machine.hpp"

#include <algorithm>
#include <atomic>

namespace rbvi {

namespace {

struct Points {
  const double *parameters, *coordinates;
  std::size_t count;
};

/// Of few, for which a call of memmove takes longer.
double *copied(const double *from, int count, double *to) {
  for (const double *end = from + count; from != end; ++from, ++to) {
    *to = *from;
    std::atomic_signal_fence(std::memory_order_acq_rel); // keeps it a loop
  }
  return to;
}

void run(const std::vector<ProgramStep> &steps, double *registers) {
  for (const ProgramStep &step : steps)
    with_operation(step.operation, ValueStep{registers, step});
}

void run(const std::vector<ProgramStep> &steps, double *registers, Slopes *slopes) {
  for (const ProgramStep &step : steps)
    with_operation(step.operation, VariedStep{registers, slopes, step});
}

/// All before the coordinates.
void start(const ProgramCode &code, const double *parameters, double *registers) {
  double *behind =
      copied(code.constants.data(), static_cast<int>(code.constants.size()), registers);
  copied(parameters, code.parameters, behind);
  run(code.fixed, registers);
}

/// How many derivatives there are from `first`, of those that are computed at once.
int slopes_from(const ProgramCode &code, int first) {
  return std::min(slopes_at_once, static_cast<int>(code.by.size()) - first);
}

/// With slopes, also of the coordinates.
void start(const ProgramCode &code, const double *parameters, int first, double *registers,
           Slopes *slopes) {
  start(code, parameters, registers);
  std::fill_n(slopes, code.first_coordinate + code.coordinates, Slopes{});
  bool varied = false;
  for (int k = 0; k < slopes_from(code, first); ++k) {
    slopes[code.by[first + k]][k] = 1;
    varied |= code.by[first + k] < code.first_coordinate;
  }
  if (varied) run(code.fixed, registers, slopes);
}

void gradient_at_point(const ProgramCode &code, const Points &point, int first, double *results,
                       double *gradients) {
  std::array<double, most_registers> registers; // not initialised, as all below
  std::array<Slopes, most_registers> slopes;
  start(code, point.parameters, first, registers.data(), slopes.data());
  copied(point.coordinates, code.coordinates, &registers[code.first_coordinate]);
  run(code.steps, registers.data(), slopes.data());
  for (std::size_t k = 0; k < code.results.size(); ++k) {
    results[k] = registers[code.results[k]];
    for (int j = 0; j < slopes_from(code, first); ++j)
      gradients[k * code.by.size() + first + j] = slopes[code.results[k]][j];
  }
}

/// Those that follow `first`.
struct BlockOfPoints {
  std::size_t first, count, all;
  std::size_t vectors() const { return (count + vector_size - 1) / vector_size; }
  std::size_t lanes() const { return vector_size * vectors(); }
};

BlockOfPoints block_of_points(std::size_t first, std::size_t all) {
  return {first, std::min(block_size, all - first), all};
}

void load(const ProgramCode &code, const double *coordinates, const BlockOfPoints &points,
          Block *registers) {
  for (int k = 0; k < code.coordinates; ++k) {
    double *target = registers[code.first_coordinate + k].data();
    std::copy_n(coordinates + k * points.all + points.first, points.count, target);
    std::fill(target + points.count, target + points.lanes(), target[0]);
  }
}

void store(const ProgramCode &code, const Block *registers, const BlockOfPoints &points,
           double *results) {
  for (std::size_t k = 0; k < code.results.size(); ++k)
    std::copy_n(registers[code.results[k]].data(), points.count,
                results + k * points.all + points.first);
}

void values_in_blocks(const ProgramCode &code, const Points &points, const double *started,
                      double *results) {
  std::array<Block, most_registers> registers;
  for (int i = 0; i < code.first_coordinate; ++i)
    std::fill_n(registers[i].data(), block_of_points(0, points.count).lanes(), started[i]);
  for (std::size_t first = 0; first < points.count; first += block_size) {
    const BlockOfPoints block = block_of_points(first, points.count);
    load(code, points.coordinates, block, registers.data());
    for (const ProgramStep &step : code.steps)
      with_operation(step.operation, BlockStep{registers.data(), block.vectors(), step});
    store(code, registers.data(), block, results);
  }
}

void gradients_in_blocks(const ProgramCode &code, const Points &points, int first_slot,
                         double *results, double *gradients) {
  std::array<double, most_registers> started;
  std::array<Slopes, most_registers> slopes_of;
  start(code, points.parameters, first_slot, started.data(), slopes_of.data());
  std::array<Block, most_registers> registers;
  std::array<std::array<Block, slopes_at_once>, most_registers> slopes;
  std::array<std::array<bool, slopes_at_once>, most_registers> varies;
  const std::size_t lanes = block_of_points(0, points.count).lanes();
  for (int i = 0; i < code.first_coordinate + code.coordinates; ++i) {
    if (i < code.first_coordinate) std::fill_n(registers[i].data(), lanes, started[i]);
    for (int k = 0; k < slopes_at_once; ++k) {
      varies[i][k] = slopes_of[i][k] != 0;
      if (varies[i][k]) std::fill_n(slopes[i][k].data(), lanes, slopes_of[i][k]);
    }
  }
  for (std::size_t first = 0; first < points.count; first += block_size) {
    const BlockOfPoints block = block_of_points(first, points.count);
    load(code, points.coordinates, block, registers.data());
    for (const ProgramStep &step : code.steps)
      with_operation(step.operation, VariedBlockStep{registers.data(), slopes.data(), varies.data(),
                                                     block.vectors(), step});
    store(code, registers.data(), block, results);
    for (std::size_t k = 0; k < code.results.size(); ++k)
      for (int j = 0; j < slopes_from(code, first_slot); ++j) {
        double *to = gradients + (k * code.by.size() + first_slot + j) * block.all + first;
        if (varies[code.results[k]][j])
          std::copy_n(slopes[code.results[k]][j].data(), block.count, to);
        else
          std::fill_n(to, block.count, 0);
      }
  }
}

} // namespace

void BoundProgram::values(const double *parameters, const double *coordinates, std::size_t count,
                          double *results) const {
  std::array<double, most_registers> registers;
  start(code_, parameters, registers.data());
  if (count != 1)
    return values_in_blocks(code_, {parameters, coordinates, count}, registers.data(), results);
  copied(coordinates, code_.coordinates, &registers[code_.first_coordinate]);
  run(code_.steps, registers.data());
  for (const int result : code_.results)
    *results++ = registers[result];
}

void BoundProgram::values_and_gradients(const double *parameters, const double *coordinates,
                                        std::size_t count, double *results,
                                        double *gradients) const {
  const auto &at = count == 1 ? gradient_at_point : gradients_in_blocks;
  for (int first = 0; first == 0 || first < static_cast<int>(code_.by.size());
       first += slopes_at_once)
    at(code_, {parameters, coordinates, count}, first, results, gradients);
}

} // namespace rbvi
