// What is said of wrong case files.
#pragma once

#include "block_case.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/scene/case.hpp"

#include <gtest/gtest.h>

namespace rbvi::wrong_cases_test {

/// What is said of a text; "" if nothing is.
inline std::string said(const std::string &text) {
  try {
    (void)make_scene(read_case(text, "x.yaml"), {});
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input) << error.what();
    return error.what();
  }
  return "";
}

struct Wrong {
  Sections sections;
  std::string says;
};

inline void expect_refused(const std::vector<Wrong> &all) {
  for (const auto &[sections, says] : all) {
    const std::string text = block_case(sections), message = said(text);
    EXPECT_NE(message.find(says), std::string::npos)
        << text << "\n  expected " << says << "\n  got " << message;
    EXPECT_TRUE(message.starts_with("x.yaml:") || message.starts_with("the case file x.yaml"))
        << message;
  }
}

} // namespace rbvi::wrong_cases_test
