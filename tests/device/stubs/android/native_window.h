#pragma once
// Debian's NDK headers lack this one; nothing here looks inside a window.
#include <stdint.h>
typedef struct ANativeWindow ANativeWindow;
typedef struct ARect {
  int32_t left, top, right, bottom;
} ARect;
