def pytest_addoption(parser):
    parser.addoption("--command", default="breakaway", help="the command to compare with")
