// The program `burnish`.

#include "cli/command_line.h"

int main(int argc, char** argv) { return burnish::run_command_line(argc, argv); }
