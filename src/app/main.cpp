// The program's entry.
#include "app/run.h"

int main(int argc, char** argv) {
    return render2mpeg::app::run(argc, argv);
}
