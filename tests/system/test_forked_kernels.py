"""The kernels of the tests are kernels as any other: they can be interrupted, started anew and ended."""

import os

import psutil
import pytest
from forked_kernels import Copy
from jupyter_client.manager import start_new_kernel

pytestmark = pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="processes are not copied on this system")


def printed(client, code: str) -> str:
    texts = []
    client.execute_interactive(code, timeout=60, output_hook=lambda message: texts.append(message["content"]))
    return "".join(each["text"] for each in texts if "text" in each)


@pytest.fixture
def started(tmp_path):
    manager, client = start_new_kernel(kernel_name="python3", cwd=str(tmp_path))
    yield manager, client
    client.stop_channels()
    manager.shutdown_kernel(now=True)


def test_a_copy_has_its_own_folder_and_nothing_of_ours(started, tmp_path):
    manager, client = started
    assert isinstance(manager.provisioner.process, Copy)
    asked = "import os, sys; print(os.getcwd(), *sys.path, *(name for name in sys.modules if 'npslam' in name))"
    folder, first, *others = printed(client, asked).split(" ")
    assert folder == str(tmp_path) and first == ""
    assert not [each for each in others if each.endswith("helpers") or each.startswith("npslam")]


def test_a_copy_is_interrupted_and_started_anew(started):
    manager, client = started
    waiting = client.execute("import time; time.sleep(60)")
    while client.get_iopub_msg(timeout=60)["msg_type"] != "execute_input":
        pass
    manager.interrupt_kernel()
    reply = client.get_shell_msg(timeout=60)
    assert reply["parent_header"]["msg_id"] == waiting and reply["content"]["ename"] == "KeyboardInterrupt"
    first = psutil.Process(manager.provisioner.pid)
    manager.restart_kernel(now=True)
    client.wait_for_ready(timeout=60)
    assert not first.is_running() and printed(client, "print('time' in globals())") == "False\n"


@pytest.mark.parametrize("now", [True, False])
def test_a_copy_ends_when_it_is_asked_to(tmp_path, now):
    manager, client = start_new_kernel(kernel_name="python3", cwd=str(tmp_path))
    client.stop_channels()
    kernel = psutil.Process(manager.provisioner.pid)
    manager.shutdown_kernel(now=now)
    assert kernel.wait(60) is None


def test_a_kernel_with_an_environment_of_its_own_is_no_copy(tmp_path):
    manager, client = start_new_kernel(kernel_name="python3", cwd=str(tmp_path), env=os.environ | {"A_NAME": "value"})
    assert not isinstance(manager.provisioner.process, Copy)
    assert printed(client, "import os; print(os.environ['A_NAME'])") == "value\n"
    client.stop_channels()
    manager.shutdown_kernel(now=True)
