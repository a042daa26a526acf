#include "rbvi/mor/published/reductions.hpp"
#include "rbvi/tool/rbvi_main.hpp"

int main(int argc, char **argv) {
  rbvi::add_published_reductions();
  return rbvi::rbvi_main(argc, argv, {});
}
