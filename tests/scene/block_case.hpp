// The text of a case, with other lines for some of its sections.
#pragma once

#include <map>
#include <string>

namespace rbvi {

using Sections = std::map<std::string, std::string>;

/// A block on a floor. An empty text takes its section away.
inline std::string block_case(const Sections &other = {}) {
  Sections sections{
      {"rbvi", "1"},
      {"physics", "plane_strain"},
      {"mesh", "{built_in: one_block}"},
      {"parameters", "{depth: {range: [0.01, 0.1], default: 0.05}, "
                     "k: {range: [0.5, 20], default: 1}, nu: {range: [0.1, 0.4], default: 0.3}, "
                     "young: {default: 15, limits: [1, 100]}}"},
      {"materials", "{rubber: {at: all, E: young*k, nu: nu}}"},
      {"imposed", "{top: {at: top, ux: 0, uy: -depth}}"},
      {"contact", "{floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}}}"}};
  for (const auto &[name, text] : other)
    sections[name] = text;
  std::string all;
  for (const auto &[name, text] : sections)
    if (!text.empty()) all += name + ": " + text + "\n";
  return all;
}

} // namespace rbvi
