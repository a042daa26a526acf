// What a reduced model is, for people.
#pragma once

#include "rbvi/model/model.hpp"

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace rbvi {

/// Scene and options, parameters with units and bounds, sizes, settings, expected errors.
void print_model(std::ostream &out, const ReducedModel &model);

/// One line: the errors measured over the validation set, or that none were.
void print_expected_errors(std::ostream &out, const ReducedModel &model);

/// "wrote run/x/u.vtu, run/x/u_contact.vtu": files or directories, one line.
void print_written(std::ostream &out, const std::vector<std::filesystem::path> &paths);

/// A line where the law of the model has several answers (has_several_answers).
void print_several_answers(std::ostream &out, const ReducedModel &model);

/// A line where reactions are not in balance with the other forces on their bodies
/// (mor/reduced_balance.hpp).
void warn_of_balance(std::ostream &out, const ReducedModel &model);

/// A line where so many of `all` answers are not the only ones to the law of friction.
void warn_of_other_answers(std::ostream &out, long not_alone, long all);

} // namespace rbvi
