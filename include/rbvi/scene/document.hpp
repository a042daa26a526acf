// Case files as YAML: its one reader, which the online library does not have.
#pragma once

#include "rbvi/scene/tree.hpp"

namespace rbvi {

/// One document whose root is a table. Throws bad_input with the line of what YAML does not allow,
/// or reads as something else than meant: a name twice, a tab, a value over several lines.
CaseNode parse_document(const std::string &text, const std::string &file);

} // namespace rbvi
