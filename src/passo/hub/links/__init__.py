"""The links to printers, one module for each firmware's interface. They need `passo[hub]`."""
