// What precompiled headers are compiled for; see CMakeLists.txt.
